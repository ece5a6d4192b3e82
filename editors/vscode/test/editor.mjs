// Tests the packaged extension in a real editor: code-server in headless Chromium.
//
//   node test/editor.mjs EDITOR_FOLDER EXTENSION.vsix [SCREENSHOTS [PART_OF_A_NAME]]
//
// EDITOR_FOLDER is where install_editor.sh installed code-server. The test opens the melon mould of examples/, sees a diagnostic
// come and go, renames a variable, sets a breakpoint in O8101, steps in, steps back, and sees the part follow the cursor.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [editorFolder, vsix, screenshots, only] = process.argv.slice(2);
if (!editorFolder || !vsix) {
  console.error("give the folder of code-server and the packaged extension");
  process.exit(2);
}
const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const place = mkdtempSync(join(tmpdir(), "editor-test-"));
const folder = join(place, "mould");
const data = join(place, "data");
cpSync(join(root, "examples/melon-mould"), folder, { recursive: true });
mkdirSync(join(data, "User"), { recursive: true });
writeFileSync(
  join(data, "User/settings.json"),
  JSON.stringify({
    "security.workspace.trust.enabled": false,
    "workbench.startupEditor": "none",
    "workbench.colorTheme": "Default Light Modern",
    "telemetry.telemetryLevel": "off",
    "files.autoSave": "off",
    "editor.minimap.enabled": false,
    "debug.toolBarLocation": "docked",
    // A program beside the one in the extension.
    ...(process.env.GCODE_SIM ? { "gcode-sim.path": process.env.GCODE_SIM } : {}),
  }),
);

const codeServer = [join(editorFolder, "node_modules/code-server"), "--user-data-dir", data, "--extensions-dir", join(place, "extensions")];
execFileSync(process.execPath, [...codeServer, "--install-extension", resolve(vsix)], { stdio: "inherit" });

function freePort() {
  return new Promise((done) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => done(port));
    });
  });
}

const port = await freePort();
const flags = ["--auth", "none", "--bind-addr", `127.0.0.1:${port}`, "--disable-telemetry", "--disable-update-check", "--disable-workspace-trust"];
const server = spawn(process.execPath, [...codeServer, ...flags], { stdio: "ignore" });
const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const args = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const browser = await chromium.launch({ executablePath, args });
let page;

async function until(what, condition, seconds = 30) {
  const end = Date.now() + 1000 * seconds;
  for (;;) {
    try {
      if (await condition()) return;
    } catch {
      // The element is not there yet.
    }
    if (Date.now() > end) throw new Error(`not within ${seconds} s: ${what}`);
    await new Promise((done) => setTimeout(done, 200));
  }
}

async function shot(name) {
  if (!screenshots) return;
  mkdirSync(screenshots, { recursive: true });
  await page.screenshot({ path: join(screenshots, `${name}.png`) });
}

async function command(name) {
  const first = page.locator(".quick-input-list .monaco-list-row").first();
  await until(`the command ${name}`, async () => {
    await page.keyboard.press("Escape");
    await page.keyboard.press("F1");
    await page.locator(".quick-input-widget input.input").first().fill(`>${name}`, { timeout: 2000 });
    await new Promise((done) => setTimeout(done, 500));
    return (await first.textContent({ timeout: 2000 })).includes(name);
  });
  await page.keyboard.press("Enter");
}

async function goToLine(line, column = 1) {
  await page.locator(".editor-instance .view-lines").first().click();
  await page.keyboard.press("Control+g");
  await page.keyboard.type(`:${line}:${column}`);
  await page.keyboard.press("Enter");
  await until(`line ${line}`, async () => (await position()).includes(`Ln ${line},`));
}

async function open(file) {
  await page.keyboard.press("Control+Shift+e");
  await page.locator(".explorer-folders-view").waitFor();
  const row = page.locator(".explorer-folders-view .monaco-list-row", { hasText: file }).first();
  await row.dblclick();
  await until(`the tab of ${file}`, async () => (await page.locator(".tab.active").first().textContent()).includes(file));
  await page.locator(".editor-instance .view-lines").first().waitFor();
}

const squiggles = () => page.locator(".squiggly-error, .squiggly-warning").count();
const position = async () => (await page.locator("#status\\.editor\\.selection").textContent()) ?? "";
const saved = (name) => readFileSync(join(folder, name), "latin1");
// The line, from 1, of a saved program that holds a text; a text that no line holds is an error.
function lineOf(name, text) {
  const line = saved(name).split(/\r?\n/).findIndex((each) => each.includes(text));
  assert(line >= 0, `no line of ${name} holds ${text}`);
  return line + 1;
}
const stoppedLine = async () => (await page.locator(".debug-call-stack .monaco-list-row.selected, .debug-call-stack .monaco-list-row").allTextContents()).join(" | ");

const stepBack = () => page.locator(".codicon-debug-step-back").first().click();

// The text of the page in the panel: it is in a frame of a frame.
async function partText() {
  for (const frame of page.frames()) {
    const picked = await frame.locator("#picked").textContent({ timeout: 200 }).catch(() => null);
    if (picked !== null) return picked;
  }
  return "";
}

const steps = {
  async "a right program has no diagnostic"() {
    await open("O8100.nc");
    await until("the lenses of the language server", async () => (await page.locator(".codelens-decoration").count()) > 0, 60);
    assert.equal(await squiggles(), 0);
    await shot("1-open");
  },
  async "a slip is underlined while it is there"() {
    await open("O8101.nc");
    await goToLine(43);
    await page.keyboard.press("End");
    await page.keyboard.press("Enter");
    await page.keyboard.type("IF[#1 GT 2GOTO 20");
    await until("a squiggle", async () => (await squiggles()) > 0);
    await shot("2-slip");
    await until("no squiggle", async () => {
      await page.keyboard.press("Control+z");
      return (await squiggles()) === 0;
    });
    await command("File: Revert File");
  },
  async "a local variable is renamed in its program"() {
    await open("O8101.nc");
    const before = saved("O8101.nc");
    const line = before.split(/\r?\n/).findIndex((text) => text.startsWith("#24=")) + 1;
    await goToLine(line, 2);
    await page.keyboard.press("F2");
    await until("the box for the new name", async () => page.locator(".rename-box .rename-input").isVisible());
    await page.keyboard.press("Control+a");
    await page.keyboard.type("#31");
    await page.keyboard.press("Enter");
    await until("the renamed variable", async () => (await page.locator(".view-lines").first().textContent()).includes("#31="));
    await page.keyboard.press("Control+s");
    const count = (text, name) => text.split(name).length - 1;
    await until("the saved file", async () => count(saved("O8101.nc"), "#31") === count(before.replace(/\(.*\)/g, ""), "#24"));
    await shot("3-renamed");
    writeFileSync(join(folder, "O8101.nc"), before, "latin1");
    await until("the file as before", async () => (await page.locator(".view-lines").first().textContent()).includes("#24="));
  },
  async "the part follows the cursor, and the cursor the part"() {
    await open("O8100.nc");
    await command("G-code: Show the Part Beside the Text");
    await until("the part", async () => (await partText()) !== "", 60);
    const call = lineOf("O8100.nc", "(HOLE 5)");
    await goToLine(call);
    await until("the moves of the call", async () => /O8100:\d+ .*HOLE 5/.test(await partText()));
    // A macro of the run is followed in the same drawing.
    await open("O8101.nc");
    const feed = lineOf("O8101.nc", "(TO THE DEPTH)");
    await goToLine(feed);
    await until("the moves of a block of the macro", async () => /^10 moves\. .*O8101:/.test(await partText()));
    await shot("4-part");
  },
  async "a breakpoint in O8101 stops, and a step goes in and back"() {
    await open("O8101.nc");
    const feed = lineOf("O8101.nc", "(TO THE DEPTH)");
    await goToLine(feed);
    await command("Debug: Toggle Breakpoint");
    await until("the breakpoint", async () => (await page.locator(".codicon-debug-breakpoint").count()) > 0);
    await open("O8100.nc");
    await command("G-code: Debug the Program");
    await until("the stop at the entry", async () => (await stoppedLine()).includes("O8100"), 60);
    await page.keyboard.press("F5");
    // The operator sets the head first.
    await until("the stop at #3006", async () => /O8102/.test(await stoppedLine()), 60);
    await shot("5-operator-stop");
    await page.keyboard.press("F5");
    await until("the stop in O8101", async () => /O8101/.test(await stoppedLine()) && (await position()).includes(`Ln ${feed},`), 60);
    await shot("6-breakpoint");
    await page.keyboard.press("F10");
    await until("the next block", async () => (await position()).includes(`Ln ${feed + 1},`));
    await stepBack();
    await until("the block before", async () => (await position()).includes(`Ln ${feed},`));
    await stepBack();
    // The loop of the pecks has no turn here: the block that ran before it is its WHILE.
    const loop = lineOf("O8101.nc", "WHILE[");
    await until("the block before it", async () => (await position()).includes(`Ln ${loop},`));
    await shot("7-back");
    await page.keyboard.press("Shift+F5");
    await until("the end of the session", async () => (await page.locator(".debug-toolbar:visible").count()) === 0);
  },
};

const chosen = Object.entries(steps).filter(([name]) => name.includes(only ?? ""));
let failed = 0;
try {
  await until("the editor", async () => (await fetch(`http://127.0.0.1:${port}/healthz`)).ok, 60);
  page = await browser.newPage({ viewport: { width: 1500, height: 950 } });
  await page.goto(`http://127.0.0.1:${port}/?folder=${encodeURIComponent(folder)}`);
  await page.locator(".monaco-workbench").waitFor({ timeout: 60_000 });
  await until("the explorer", async () => (await page.locator(".explorer-folders-view").textContent()).includes("O8100.nc"), 60);
  for (const [name, step] of chosen) {
    try {
      await step();
      console.log(`ok      ${name}`);
    } catch (error) {
      failed += 1;
      await shot(`failed-${failed}`);
      const notes = await page.locator(".notification-toast .notification-list-item-message").allTextContents();
      console.log(`FAILED  ${name}: ${error.message}${notes.map((note) => `\n        the editor says: ${note}`).join("")}`);
    }
  }
} finally {
  await browser.close();
  server.kill();
  rmSync(place, { recursive: true, force: true });
}
console.log(`${chosen.length - failed} passed, ${failed} failed`);
process.exit(failed === 0 ? 0 : 1);
