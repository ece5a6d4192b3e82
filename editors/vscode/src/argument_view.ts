// Sliders for the arguments of the macro call at the cursor. A slider runs the program with its value; the text stays.
import * as vscode from "vscode";

export interface Argument {
  letter: string;
  value: number;
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
    return { letter: word[1].toUpperCase(), value: Number(word[2]), range, version: document.version };
  });
}

// Returns the text of a document with other values of arguments.
export function withArguments(document: vscode.TextDocument, values: Argument[]): string {
  const text = document.getText();
  const edits = values.map(({ range, value }) => [document.offsetAt(range.start), document.offsetAt(range.end), decimal(value)] as const);
  return edits.reduceRight((before, [start, end, word]) => before.slice(0, start) + word + before.slice(end), text);
}

// Returns a number with a decimal point: without one a control may count increments.
function decimal(value: number): string {
  const text = value.toFixed(3).replace(/0+$/, "");
  return text === "-0." ? "0." : text;
}

export class ArgumentView implements vscode.WebviewViewProvider {
  private view: vscode.WebviewView | undefined;
  private shown: Argument[] = [];

  constructor(private readonly changed: (values: Argument[]) => void) {}

  resolveWebviewView(view: vscode.WebviewView): void {
    this.view = view;
    view.webview.options = { enableScripts: true };
    view.webview.onDidReceiveMessage((values: number[]) => this.changed(this.shown.map((argument, index) => ({ ...argument, value: values[index] }))));
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
    const rows = this.shown.map(({ letter, value }) => {
      const reach = Math.max(Math.abs(value), 10);
      return `<label>${letter} <input type="range" min="${value - reach}" max="${value + reach}" step="${reach / 200}" value="${value}"><output>${value}</output></label>`;
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
  input.nextElementSibling.textContent = Number(input.value).toFixed(3);
  api.postMessage(inputs.map((one) => Number(one.value)));
});
</script>`;
  }
}
