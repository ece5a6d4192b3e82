// The part beside the text: a page of the active program that follows the cursor and the text.
import { basename } from "node:path";
import * as vscode from "vscode";
import type { LanguageClient } from "vscode-languageclient/node";

import { Argument, ArgumentView, argumentsOf, withArguments } from "./argument_view";

// Delay between the last keystroke and a new picture, ms.
const DELAY = 250;

export class PartPanel implements vscode.Disposable {
  private panel: vscode.WebviewPanel | undefined;
  private document: vscode.TextDocument | undefined;
  private timer: NodeJS.Timeout | undefined;
  // Files of the drawn run: that of the program, and those of the programs that it calls.
  private files: string[] = [];
  // Number of the last request: an answer to an older one is dropped.
  private request = 0;
  private readonly arguments: ArgumentView;
  private readonly registered: vscode.Disposable;

  constructor(
    context: vscode.ExtensionContext,
    private readonly client: () => LanguageClient | undefined,
  ) {
    this.arguments = new ArgumentView((values) => this.showWith(values));
    this.registered = vscode.Disposable.from(
      vscode.window.registerWebviewViewProvider("gcode-sim.arguments", this.arguments),
      vscode.workspace.onDidChangeTextDocument(({ document }) => this.follows(document) && this.later()),
      vscode.workspace.onDidChangeTextDocument(({ document }) => this.renew(document)),
      vscode.window.onDidChangeTextEditorSelection(({ textEditor }) => this.select(textEditor)),
      vscode.window.onDidChangeActiveTextEditor((editor) => editor && this.panel && this.change(editor)),
    );
    context.subscriptions.push(this.registered);
  }

  dispose(): void {
    this.panel?.dispose();
  }

  open(): void {
    const editor = vscode.window.activeTextEditor;
    if (!editor) return;
    if (!this.panel) {
      const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      this.panel = vscode.window.createWebviewPanel("gcode-sim.part", "Part", place, { enableScripts: true });
      this.panel.onDidDispose(() => {
        this.panel = undefined;
        void vscode.commands.executeCommand("setContext", "gcode-sim.partIsOpen", false);
      });
      this.panel.webview.onDidReceiveMessage((message: { files?: string[]; file?: string; line?: number }) => {
        if (message.files) this.files = message.files;
        if (message.files && vscode.window.activeTextEditor) this.select(vscode.window.activeTextEditor);
        if (message.file && message.line) void this.reveal(message.file, message.line);
      });
      void vscode.commands.executeCommand("setContext", "gcode-sim.partIsOpen", true);
    }
    this.change(editor);
  }

  // Returns whether a change of a document may change the drawing: a called program counts.
  private follows(document: vscode.TextDocument): boolean {
    return this.panel !== undefined && (document === this.document || this.files.includes(document.uri.fsPath));
  }

  private change(editor: vscode.TextEditor): void {
    if (editor.document.languageId !== "nc") return;
    // A macro of the drawn run is followed there.
    if (this.document !== editor.document && !this.files.includes(editor.document.uri.fsPath)) {
      this.document = editor.document;
      void this.draw();
    }
    this.select(editor);
  }

  private later(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.draw(), DELAY);
  }

  // Draws the program, with another text if arguments are tried.
  private async draw(text?: string): Promise<void> {
    const { panel, document } = this;
    if (!panel || !document) return;
    const request = ++this.request;
    panel.title = `Part: ${basename(document.uri.fsPath)}`;
    const argument = { uri: document.uri.toString(), ...(text === undefined ? {} : { text }) };
    let html: string;
    try {
      const answer = await this.client()?.sendRequest<{ html: string }>("workspace/executeCommand", { command: "gcode-sim.page", arguments: [argument] });
      html = answer?.html ?? "";
    } catch (error) {
      html = `<!DOCTYPE html><p>${String(error).replace(/[&<]/g, (sign) => `&#${sign.charCodeAt(0)};`)}</p>`;
    }
    if (request === this.request && this.panel === panel) panel.webview.html = html;
  }

  private select(editor: vscode.TextEditor): void {
    if (!this.panel || editor.document.languageId !== "nc") return;
    const { line } = editor.selection.active;
    void this.panel.webview.postMessage({ file: editor.document.uri.fsPath, line: line + 1 });
    // A text of a called macro can't be tried: the server runs another text of the drawn program alone.
    this.arguments.show(editor.document === this.document ? argumentsOf(editor.document, line) : []);
  }

  // Reads the arguments of the call again after a change of its text.
  private renew(document: vscode.TextDocument): void {
    const editor = vscode.window.activeTextEditor;
    if (editor && editor.document === document && document === this.document) this.select(editor);
  }

  private showWith(values: Argument[]): void {
    const { document } = this;
    if (document && values.every(({ version }) => version === document.version)) void this.draw(withArguments(document, values));
  }

  private async reveal(file: string, line: number): Promise<void> {
    const known = vscode.workspace.textDocuments.find((document) => document.uri.fsPath === file);
    const document = known ?? (await vscode.workspace.openTextDocument(file));
    const at = new vscode.Range(line - 1, 0, line - 1, 0);
    await vscode.window.showTextDocument(document, { viewColumn: vscode.ViewColumn.One, preserveFocus: true, selection: at });
  }
}
