// Finds the program gcode-sim: the configured one, the one in the extension, or the one on the path.
import { existsSync } from "node:fs";
import { join } from "node:path";
import * as vscode from "vscode";

export function binary(context: vscode.ExtensionContext): string {
  const configured = vscode.workspace.getConfiguration("gcode-sim").get<string>("path")?.trim();
  if (configured) return configured;
  const name = process.platform === "win32" ? "gcode-sim.exe" : "gcode-sim";
  const packaged = join(context.extensionPath, "bin", name);
  return existsSync(packaged) ? packaged : name;
}
