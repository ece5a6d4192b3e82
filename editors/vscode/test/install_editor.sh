#!/usr/bin/env bash
# Installs code-server, the editor of the test, into a folder: `install_editor.sh FOLDER`. Needs npm, and a compiler for its modules.
set -euo pipefail
export npm_config_yes=true
mkdir -p "$1"
cd "$1"
[ -f package.json ] || echo '{ "private": true }' >package.json
npm install --no-audit --no-fund --ignore-scripts --silent code-server@4.100.3
cd node_modules/code-server
modules=(node-pty @vscode/spdlog @parcel/watcher native-watchdog)
(cd ../.. && npm rebuild --ignore-scripts=false argon2) >/dev/null
(cd lib/vscode && npm install --omit=dev --no-audit --no-fund --ignore-scripts --silent \
    && npm rebuild --ignore-scripts=false "${modules[@]}" >/dev/null && ln -sfn node_modules node_modules.asar)
(cd lib/vscode/extensions && npm install --omit=dev --no-audit --no-fund --ignore-scripts --silent && ln -sfn node_modules node_modules.asar)
