// The test explorer: each folder with an accepted.json is a case of `gcode-sim test`.
import { execFile } from "node:child_process";
import { dirname } from "node:path";
import * as vscode from "vscode";

import { binary } from "./binary";

interface Case {
  name: string;
  file: string;
  answer: string;
  changes: { code: string; message: string }[];
}

export function registerTests(context: vscode.ExtensionContext): vscode.Disposable {
  const controller = vscode.tests.createTestController("gcode-sim", "NC programs");
  const pattern = "**/accepted.json";
  const add = (accepted: vscode.Uri) => {
    const folder = vscode.Uri.file(dirname(accepted.fsPath));
    controller.items.add(controller.createTestItem(folder.fsPath, vscode.workspace.asRelativePath(folder), folder));
  };
  controller.resolveHandler = async (item) => {
    if (!item) (await vscode.workspace.findFiles(pattern)).forEach(add);
  };
  const watcher = vscode.workspace.createFileSystemWatcher(pattern, false, true, false);
  watcher.onDidCreate(add);
  watcher.onDidDelete((accepted) => controller.items.delete(dirname(accepted.fsPath)));
  const profile = (label: string, flags: string[]) =>
    controller.createRunProfile(label, vscode.TestRunProfileKind.Run, (request, cancelled) => runCases(context, controller, request, flags, cancelled), flags.length === 0);
  profile("Compare with the accepted results", []);
  profile("Accept the new results", ["--accept"]);
  return vscode.Disposable.from(controller, watcher);
}

async function runCases(
  context: vscode.ExtensionContext,
  controller: vscode.TestController,
  request: vscode.TestRunRequest,
  flags: string[],
  cancelled: vscode.CancellationToken,
): Promise<void> {
  const run = controller.createTestRun(request);
  const items: vscode.TestItem[] = [];
  if (request.include) items.push(...request.include);
  else controller.items.forEach((item) => items.push(item));
  for (const item of items.filter((item) => !request.exclude?.includes(item))) {
    if (cancelled.isCancellationRequested) break;
    run.started(item);
    try {
      const { cases, text } = await results(binary(context), item.id, flags);
      run.appendOutput(text.replace(/\r?\n/g, "\r\n"), undefined, item);
      const changed = cases.filter((one) => !["same", "accepted"].includes(one.answer));
      if (cases.length > 0 && changed.length === 0) run.passed(item);
      else run.failed(item, changed.map(message).concat(cases.length === 0 ? [new vscode.TestMessage(text || "no case ran")] : []));
    } catch (error) {
      run.errored(item, new vscode.TestMessage(String(error)));
    }
  }
  run.end();
}

function message(one: Case): vscode.TestMessage {
  const lines = one.changes.map(({ code, message }) => `${code}: ${message}`);
  return new vscode.TestMessage([`${one.name}: ${one.answer}`, ...lines].join("\n"));
}

// Runs the cases of a folder; the messages of the program are the text.
function results(command: string, folder: string, flags: string[]): Promise<{ cases: Case[]; text: string }> {
  return new Promise((resolve, reject) => {
    const options = { cwd: folder, maxBuffer: 1 << 28 };
    execFile(command, ["test", folder, "--format", "json", ...flags], options, (error, out, text) => {
      try {
        resolve({ cases: JSON.parse(out).cases, text });
      } catch {
        reject(text || error);
      }
    });
  });
}
