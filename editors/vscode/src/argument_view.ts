// Sliders for the arguments of the macro call at the cursor. A slider runs the program with its value; the text stays.
import * as vscode from "vscode";

import { numberLike, sliderOf } from "./slider";

export interface Argument {
  letter: string;
  // Number as the text has it.
  word: string;
  range: vscode.Range;
  // Version of the text that has the range.
  version: number;
}

// Returns the numeric arguments of a G65 or G66 block; none if the line has no such code.
export function argumentsOf(document: vscode.TextDocument, line: number): Argument[] {
  const blanked = (part: string) => " ".repeat(part.length);
  let text = document.lineAt(line).text.replace(/\([^)]*\)?/g, blanked);
  // Expressions are no plain numbers: their brackets go from the innermost outwards.
  while (/\[[^[\]]*\]/.test(text)) text = text.replace(/\[[^[\]]*\]/g, blanked);
  if (!/G\s*6[56]/i.test(text)) return [];
  const words = text.matchAll(/([A-FH-KMQ-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))/gi);
  return [...words].map((word) => {
    const end = word.index + word[0].length;
    const range = new vscode.Range(line, end - word[2].length, line, end);
    return { letter: word[1].toUpperCase(), word: word[2], range, version: document.version };
  });
}

// Returns the text of a document with other numbers in arguments. All others stay as they are written.
export function withArguments(document: vscode.TextDocument, moved: Argument[]): string {
  const text = document.getText();
  const edits = moved.map(({ range, word }) => [document.offsetAt(range.start), document.offsetAt(range.end), word] as const);
  return edits.reduceRight((before, [start, end, word]) => before.slice(0, start) + word + before.slice(end), text);
}

export class ArgumentView implements vscode.WebviewViewProvider {
  private view: vscode.WebviewView | undefined;
  private shown: Argument[] = [];

  constructor(private readonly changed: (moved: Argument[]) => void) {}

  resolveWebviewView(view: vscode.WebviewView): void {
    this.view = view;
    view.webview.options = { enableScripts: true };
    view.webview.onDidReceiveMessage((values: (number | null)[]) => {
      const moved = (argument: Argument, index: number) => {
        const value = values[index];
        return value == null ? [] : [{ ...argument, word: numberLike(argument.word, value) }];
      };
      this.changed(this.shown.flatMap(moved));
    });
    view.onDidDispose(() => (this.view = undefined));
    this.render();
  }

  show(values: Argument[]): void {
    const key = (all: Argument[]) => JSON.stringify(all);
    if (key(values) === key(this.shown)) return;
    this.shown = values;
    this.render();
  }

  private render(): void {
    if (!this.view) return;
    const rows = this.shown.map(({ letter, word }) => {
      const { least, most, step, decimals } = sliderOf(word);
      return `<label>${letter} <input type="range" min="${least}" max="${most}" step="${step}" value="${Number(word)}" data-decimals="${decimals}"><output>${word}</output></label>`;
    });
    const nonce = Math.random().toString(36).slice(2);
    this.view.webview.html = `<!DOCTYPE html>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'nonce-${nonce}'; script-src 'nonce-${nonce}'">
<style nonce="${nonce}">label { display: flex; gap: 0.5rem; align-items: center; margin: 0.2rem 0; } input { flex: 1; min-width: 3rem; } output { min-width: 4rem; text-align: right; font-variant-numeric: tabular-nums; }</style>
${rows.join("\n") || "<p>Put the cursor on a G65 or G66 block. Its sliders run the program with other values; the text stays as it is.</p>"}
<script nonce="${nonce}">
const api = acquireVsCodeApi();
const inputs = [...document.querySelectorAll("input")];
for (const input of inputs) input.addEventListener("input", () => {
  input.dataset.moved = "";
  input.nextElementSibling.textContent = Number(input.value).toFixed(input.dataset.decimals);
  api.postMessage(inputs.map((one) => ("moved" in one.dataset ? Number(one.value) : null)));
});
</script>`;
  }
}
