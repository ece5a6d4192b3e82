// Tasks that run gcode-sim on the active program, or on a folder of cases.
import { dirname } from "node:path";
import * as vscode from "vscode";

import { binary } from "./binary";

const COMMANDS = ["run", "check", "verify", "holes", "test"];

export function registerTasks(context: vscode.ExtensionContext): vscode.Disposable[] {
  const provider: vscode.TaskProvider = {
    provideTasks: () => {
      const document = vscode.window.activeTextEditor?.document;
      if (document?.languageId !== "nc") return [];
      const file = document.uri.fsPath;
      return COMMANDS.map((command) => task(context, { type: "gcode-sim", command, file: command === "test" ? dirname(file) : file }));
    },
    resolveTask: (known) => {
      if (!COMMANDS.includes(known.definition.command)) return undefined;
      // The editor accepts a resolved task only with the very object of its definition.
      return task(context, known.definition);
    },
  };
  return [vscode.tasks.registerTaskProvider("gcode-sim", provider)];
}

function task(context: vscode.ExtensionContext, definition: vscode.TaskDefinition): vscode.Task {
  const { command, file = "${file}" } = definition;
  const name = `${command} ${vscode.workspace.asRelativePath(file)}`;
  const execution = new vscode.ProcessExecution(binary(context), [command, file]);
  return new vscode.Task(definition, vscode.TaskScope.Workspace, name, "gcode-sim", execution);
}
