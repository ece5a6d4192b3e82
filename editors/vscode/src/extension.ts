// Starts the language server and the debugger, and adds the part beside the text, tests and tasks.
import * as vscode from "vscode";
import { LanguageClient, Trace } from "vscode-languageclient/node";

import { binary } from "./binary";
import { PartPanel } from "./part_panel";
import { registerTasks } from "./tasks";
import { registerTests } from "./test_explorer";

let client: LanguageClient | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const panel = new PartPanel(context, () => client);
  context.subscriptions.push(
    panel,
    vscode.commands.registerCommand("gcode-sim.openPart", () => panel.open()),
    vscode.commands.registerCommand("gcode-sim.debugFile", debugFile),
    vscode.commands.registerCommand("gcode-sim.restartServer", () => client?.restart()),
    vscode.debug.registerDebugAdapterDescriptorFactory("gcode-sim", {
      createDebugAdapterDescriptor: () => new vscode.DebugAdapterExecutable(binary(context), ["dap"]),
    }),
    vscode.debug.registerDebugConfigurationProvider("gcode-sim", { resolveDebugConfiguration }),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("gcode-sim.path")) void start(context);
    }),
    ...registerTasks(context),
    registerTests(context),
  );
  await start(context);
}

export async function deactivate(): Promise<void> {
  await client?.stop();
}

async function start(context: vscode.ExtensionContext): Promise<void> {
  await client?.stop();
  const command = binary(context);
  client = new LanguageClient(
    "gcode-sim",
    "G-code",
    { command, args: ["lsp"] },
    {
      documentSelector: [{ language: "nc" }],
      middleware: {
        // The server answers a debug lens with a launch configuration.
        executeCommand: async (name, args, next) => {
          const answer = await next(name, args);
          if (name === "gcode-sim.debug" && answer) await vscode.debug.startDebugging(undefined, answer);
          return answer;
        },
      },
    },
  );
  const trace = vscode.workspace.getConfiguration("gcode-sim").get<string>("trace.server", "off");
  await client.setTrace(Trace.fromString(trace));
  try {
    await client.start();
  } catch (error) {
    const choice = await vscode.window.showErrorMessage(
      `${command} does not start: ${error instanceof Error ? error.message : error}. Install gcode-sim, or name it in the settings.`,
      "Open Settings",
    );
    if (choice) await vscode.commands.executeCommand("workbench.action.openSettings", "gcode-sim.path");
  }
}

async function debugFile(): Promise<void> {
  const document = vscode.window.activeTextEditor?.document;
  if (!document) return;
  await document.save();
  await vscode.debug.startDebugging(vscode.workspace.getWorkspaceFolder(document.uri), configurationOf(document));
}

function configurationOf(document: vscode.TextDocument): vscode.DebugConfiguration {
  const program = document.uri.fsPath;
  return { type: "gcode-sim", request: "launch", name: vscode.workspace.asRelativePath(program), program, stopOnEntry: true };
}

// Without a launch.json the active program is debugged.
function resolveDebugConfiguration(
  _folder: vscode.WorkspaceFolder | undefined,
  configuration: vscode.DebugConfiguration,
): vscode.DebugConfiguration | undefined {
  if (configuration.type || configuration.request) return configuration;
  const document = vscode.window.activeTextEditor?.document;
  return document?.languageId === "nc" ? configurationOf(document) : undefined;
}
