// Builds one .vsix for each platform whose gcode-sim is given, or one without a program, which uses the one on the path:
//
//   node package.mjs
//   node package.mjs linux-x64=../../target/release/gcode-sim win32-x64=gcode-sim.exe darwin-arm64=gcode-sim
import { chmod, copyFile, mkdir, rm } from "node:fs/promises";
import { execFileSync } from "node:child_process";

const platforms = ["linux-x64", "linux-arm64", "win32-x64", "win32-arm64", "darwin-x64", "darwin-arm64"];

function run(command, ...args) {
  execFileSync("npx", ["--no-install", command, ...args], { stdio: "inherit" });
}

async function pack(platform, binary) {
  await rm("bin", { recursive: true, force: true });
  if (binary) {
    const name = platform.startsWith("win32") ? "bin/gcode-sim.exe" : "bin/gcode-sim";
    await mkdir("bin");
    await copyFile(binary, name);
    await chmod(name, 0o755);
  }
  const target = platform ? ["--target", platform] : [];
  const file = `gcode-sim${platform ? `-${platform}` : ""}.vsix`;
  run("vsce", "package", "--no-dependencies", "--allow-missing-repository", "--out", file, ...target);
  await rm("bin", { recursive: true, force: true });
}

const given = process.argv.slice(2).map((argument) => argument.split("="));
for (const [platform, binary] of given) {
  if (!platforms.includes(platform) || !binary) {
    console.error(`${platform}: give PLATFORM=PROGRAM with one of ${platforms.join(", ")}`);
    process.exit(2);
  }
}
await rm("out", { recursive: true, force: true });
run("tsc", "--noEmit");
execFileSync(process.execPath, ["build.mjs"], { stdio: "inherit" });
if (given.length === 0) await pack();
for (const [platform, binary] of given) await pack(platform, binary);
