// Connects drawing, table and listing: an item selected in one is shown in the others.
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const sides = data.sides.map((side) => new Side(side, document.getElementById(`canvas-${side.word}`)));
  const viewer = new Viewer(data, sides);
  // The editor in whose panel the page is shown. It draws the page again after a change: the view stays.
  const editor = typeof acquireVsCodeApi === "function" ? acquireVsCodeApi() : null;
  if (editor) {
    document.documentElement.classList.add("panel");
    Object.assign(viewer.camera, editor.getState());
    editor.postMessage({ files: sides.flatMap((side) => Object.values(side.files)) });
  }
  const picked = document.getElementById("picked");
  const table = holeTable((row) => pickRow(row));

  // Marks a line of the listing and the lines that called it.
  function mark(anchor, callers = []) {
    document.querySelectorAll(".half.at, .half.from").forEach((half) => half.classList.remove("at", "from"));
    document.getElementById(anchor)?.classList.add("at");
    callers.forEach((caller) => document.getElementById(caller)?.classList.add("from"));
  }

  // Scrolls the programs until a line is in the part of them that the window shows, and the window only if that is not enough:
  // beside the drawing their end can be below the window's.
  function scrollTo(anchor) {
    const [pane, line] = [document.getElementById("programs"), document.getElementById(anchor)];
    if (!line || getComputedStyle(pane).overflowY !== "auto") return;
    const [inside, box] = [pane.getBoundingClientRect(), line.getBoundingClientRect()];
    const isBeside = inside.top < innerHeight / 2;
    const [top, bottom] = isBeside ? [Math.max(inside.top, 0), Math.min(inside.bottom, innerHeight)] : [inside.top, inside.bottom];
    if (box.top < top || bottom < box.bottom) pane.scrollTop += (box.top + box.bottom - top - bottom) / 2;
    const below = line.getBoundingClientRect().bottom - innerHeight;
    if (isBeside && 0 < below) scrollBy(0, below);
  }

  function land(anchor) {
    if (!document.getElementById(anchor)) return;
    if (location.hash === `#${anchor}`) document.getElementById(anchor).scrollIntoView();
    else location.hash = anchor;
  }

  const lineOf = (side, number) => {
    const [anchor, name, text] = side.lines[number];
    const [span, code] = [document.createElement("span"), document.createElement("code")];
    const there = anchor !== null && document.getElementById(anchor) !== null;
    const link = document.createElement(there ? "a" : "span");
    if (there) link.href = `#${anchor}`;
    link.textContent = name;
    code.textContent = text;
    span.append(link, " ", code);
    return span;
  };

  function describe(text, side, lines) {
    picked.replaceChildren(text);
    lines.forEach((number, place) => picked.append(place === 0 ? ". " : " called from ", lineOf(side, number)));
  }

  // Tells the editor the line of an anchor, such as new-0-12: file and line, counted from 1.
  function tellEditor(anchor) {
    if (!editor || !anchor) return;
    const [word, source, line] = anchor.split("-");
    const side = sides.find((one) => one.word === word);
    editor.postMessage({ file: side.files[source], line: Number(line) });
  }

  const name = (side) => (sides.length === 2 ? `${side.word[0].toUpperCase()}${side.word.slice(1)}, ` : "");
  const linesOf = (choice) => (choice.hole ? choice.hole.lines : choice.side.places[choice.side.at[choice.move]]);
  const anchorsOf = (choice) => linesOf(choice).map((number) => choice.side.lines[number][0]);

  // Number of the first move of a stroke, counted from 1, and of its last one.
  function numbers(side, move) {
    if (side.joined.length === 0) return `move ${move + 1}`;
    if (!side.firsts) {
      side.firsts = [1];
      side.joined.forEach((count) => side.firsts.push(side.firsts.at(-1) + count));
    }
    const [first, next] = [side.firsts[move], side.firsts[move + 1]];
    return next - first === 1 ? `move ${first}` : `moves ${first} to ${next - 1}`;
  }

  // Work coordinates after a move, with the control's own letters.
  function display(side, move) {
    const decimals = side.display_unit === "inch" ? 4 : 3;
    const shown = new Map();
    for (let at = move; at >= 0 && shown.size < side.axes.length; at--) {
      side.display[at].forEach(([axis, value]) => shown.has(axis) || shown.set(axis, value));
    }
    const axes = [...shown.keys()].sort((a, b) => a - b);
    const text = axes.map((axis) => `${side.axes[axis]} ${shown.get(axis).toFixed("ABC".includes(side.axes[axis]) ? 3 : decimals)}`);
    return text.join(" ") + (side.display_unit === "inch" ? " (inch)" : "");
  }

  // Describes a move; of several that are one line the one at a part of it, if its exact points are known.
  function pickMove(side, move, part) {
    viewer.pick = { side, move };
    const exact = side.known.get(move);
    const isOne = part !== undefined && exact && side.joined[move] === exact.length / 3 - 1;
    const points = isOne ? exact : side.xyz;
    const point = (at) => [0, 1, 2].map((axis) => `${"xyz"[axis]} ${points[3 * at + axis].toFixed(3)}`).join(" ");
    const [first, last] = isOne ? [part, part + 1] : [side.starts[move], side.starts[move + 1] - 1];
    const open = {
      start: `to ${point(last)} mm, from an unknown position`,
      end: `from ${point(last)} mm to an unknown position`,
      both: "between unknown positions",
    }[side.unplaced[move]];
    const way = open ?? `from ${point(first)} to ${point(last)} mm`;
    const all = numbers(side, move);
    const which = isOne && exact.length > 6 ? `move ${side.firsts[move] + part}` : all;
    // Inside a line of several moves the display is that at its end.
    const shown = isOne && exact.length > 6 ? "" : `, to ${display(side, move)} on the position display`;
    const others = which === all ? "" : `, one of ${all}, which begin at the block`;
    describe(`${name(side)}${which} of ${side.all_moves}, ${side.kinds[side.kind[move]]}${shown}; on the part ${way}${others}`, side, linesOf(viewer.pick));
    const [anchor, ...callers] = anchorsOf(viewer.pick);
    mark(anchor, callers);
    scrollTo(anchor);
    tellEditor(anchor);
    viewer.ask();
  }

  function pickHole(side, hole) {
    viewer.pick = { side, hole, row: hole.row ?? undefined };
    table.show(hole.row);
    const at = hole.entry.map((value, axis) => `${"xyz"[axis]} ${value.toFixed(3)}`).join(" ");
    describe(`${name(side)}hole ${hole.id} on the part at ${at}, depth ${hole.depth.toFixed(3)}`, side, hole.lines);
    const [anchor, ...callers] = anchorsOf(viewer.pick);
    mark(anchor, callers);
    tellEditor(anchor);
    viewer.ask();
  }

  function pickRow(row) {
    for (const side of [...sides].reverse()) {
      const hole = side.holes.find((one) => one.row === row);
      if (hole) return pickHole(side, hole);
    }
  }

  // Shows the moves of a line, unless it is the block of the selection already.
  function show(anchor) {
    const half = document.getElementById(anchor);
    if (!half?.classList.contains("half")) return;
    if (!editor) half.focus({ preventScroll: true });
    if (viewer.pick.side && anchorsOf(viewer.pick).includes(anchor)) {
      mark(anchor, anchorsOf(viewer.pick).filter((other) => other !== anchor));
      return;
    }
    mark(anchor);
    for (const side of sides) {
      const number = side.lines.findIndex(([name]) => name === anchor);
      if (number < 0) continue;
      viewer.pick = { line: { side, number } };
      const moves = side.at.filter((place) => side.places[place].includes(number)).length;
      describe(`${name(side)}${moves} move${moves === 1 ? "" : "s"}`, side, [number]);
    }
    viewer.ask();
  }

  function step(side, by) {
    const shown = (move) =>
      (viewer.options.rapids || side.moves[move].pen !== "rapid") && (!viewer.options.changedOnly || side.isChanged.has(move));
    let move = viewer.pick.side === side && viewer.pick.move !== undefined ? viewer.pick.move + by : by > 0 ? 0 : side.moves.length - 1;
    while (move >= 0 && move < side.moves.length && !shown(move)) move += by;
    if (move >= 0 && move < side.moves.length) pickMove(side, move);
  }

  // Plays the path: the moves made so far are drawn, those that follow are faint.
  function player(side) {
    const progress = document.getElementById("progress");
    if (!progress) return;
    const button = document.querySelector("[data-play=play]");
    let timer = null;
    const go = (moves) => {
      const upTo = Math.max(0, Math.min(side.moves.length, moves));
      viewer.options.upTo = upTo;
      progress.value = upTo;
      document.getElementById("progress-count").textContent = `${upTo} of ${side.moves.length}`;
      if (upTo > 0) pickMove(side, upTo - 1);
      viewer.ask();
    };
    const stop = () => {
      clearInterval(timer);
      timer = null;
      button.textContent = "Play";
      button.setAttribute("aria-pressed", "false");
    };
    const play = () => {
      if (timer !== null) return stop();
      // A long path takes half a minute.
      const stride = Math.max(1, Math.round(side.moves.length / 600));
      if (Number(progress.value) >= side.moves.length) go(0);
      button.textContent = "Pause";
      button.setAttribute("aria-pressed", "true");
      timer = setInterval(() => {
        go(Number(progress.value) + stride);
        if (Number(progress.value) >= side.moves.length) stop();
      }, 50);
    };
    const actions = { play, back: () => (stop(), go(Number(progress.value) - 1)), step: () => (stop(), go(Number(progress.value) + 1)) };
    document.querySelectorAll("[data-play]").forEach((one) => one.addEventListener("click", actions[one.dataset.play]));
    progress.addEventListener("input", () => (stop(), go(Number(progress.value))));
  }

  const follow = () => viewer.pick.side && land(anchorsOf(viewer.pick)[0]);

  function key(side, event) {
    const { camera } = viewer;
    const turns = { ArrowLeft: [-6, 0], ArrowRight: [6, 0], ArrowUp: [0, 6], ArrowDown: [0, -6] }[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (turns && event.shiftKey) {
      camera.pan(4 * turns[0], -4 * turns[1]);
    } else if (turns) camera.turn(...turns);
    else if (event.key === "+" || event.key === "=") camera.magnify(1.2);
    else if (event.key === "-") camera.magnify(1 / 1.2);
    else if (event.key === "0") look("first");
    else if (event.key === "n" || event.key === "N") step(side, 1);
    else if (event.key === "p" || event.key === "P") step(side, -1);
    else if (event.key === "Enter") follow();
    else return;
    event.preventDefault();
    viewer.ask();
  }

  function look(view) {
    if (view === "first") viewer.first();
    else viewer.camera.look(view);
    viewer.fit();
  }

  // One finger or the mouse rotates, two fingers zoom and pan; a drag of up to 4 pixels is a click.
  function pointers(side) {
    const { canvas } = side;
    const down = new Map();
    let far = 0;
    const spread = () => {
      const [a, b] = [...down.values()];
      return Math.hypot(a[0] - b[0], a[1] - b[1]);
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (down.size === 0) far = 0;
      down.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = down.get(event.pointerId);
      if (!last) return;
      const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
      far += Math.hypot(dx, dy);
      const before = down.size === 2 ? spread() : 0;
      down.set(event.pointerId, [event.clientX, event.clientY]);
      if (down.size === 2) {
        const [a, b] = [...down.values()];
        viewer.camera.magnify(spread() / (before || 1), ...side.fromMiddle((a[0] + b[0]) / 2, (a[1] + b[1]) / 2));
      }
      if (down.size === 2 || event.shiftKey) viewer.camera.pan(dx / down.size, dy / down.size);
      else if (far > 4) viewer.camera.turn(-0.4 * dx, 0.4 * dy);
      viewer.ask();
    });
    const up = (event) => {
      const wasClick = down.size === 1 && far <= 4 && event.type === "pointerup";
      down.delete(event.pointerId);
      if (!wasClick) return;
      const box = canvas.getBoundingClientRect();
      const choice = side.nearest(event.clientX - box.left - canvas.clientLeft, event.clientY - box.top - canvas.clientTop, viewer.options);
      if (choice?.hole) {
        pickHole(side, choice.hole);
        follow();
      } else if (choice) pickMove(side, choice.move, choice.part);
    };
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    canvas.addEventListener("dblclick", follow);
    canvas.addEventListener("keydown", (event) => key(side, event));
    const wheel = (event) => {
      event.preventDefault();
      viewer.camera.magnify(Math.exp(-0.0015 * event.deltaY), ...side.fromMiddle(event.clientX, event.clientY));
      viewer.ask();
    };
    canvas.addEventListener("wheel", wheel, { passive: false });
  }

  sides.forEach(pointers);
  player(sides.at(-1));
  document.querySelectorAll("[data-view]").forEach((button) =>
    button.addEventListener("click", () => {
      const factor = { in: 1.2, out: 1 / 1.2 }[button.dataset.view];
      if (!factor) return look(button.dataset.view);
      viewer.camera.magnify(factor);
      viewer.ask();
    }),
  );
  const box = (id, option) =>
    document.getElementById(id)?.addEventListener("change", (event) => {
      viewer.options[option] = event.target.checked;
      viewer.ask();
    });
  box("rapids", "rapids");
  box("changed-only", "changedOnly");

  // A sticky drawing covers lines: the target of a link is scrolled to below it. A long page is slow to lay out again, and a long path
  // to draw, where nothing has changed.
  let measured = null;
  function measure() {
    const element = document.getElementById("viewer");
    const sizes = [element, ...sides.map((side) => side.canvas)].map((one) => `${one.offsetWidth} ${one.offsetHeight}`).join();
    if (sizes === measured) return;
    measured = sizes;
    const { style } = document.documentElement;
    const height = getComputedStyle(element).position === "sticky" ? `${element.offsetHeight}px` : "0px";
    if (height !== (style.getPropertyValue("--viewer") || "0px")) style.setProperty("--viewer", height);
    viewer.fit();
  }
  new ResizeObserver(measure).observe(document.getElementById("viewer"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => viewer.ask());
  const paper = (on) => {
    document.documentElement.classList.toggle("paper", on);
    viewer.isOnPaper = on;
    viewer.scales = null;
    viewer.draw();
  };
  addEventListener("beforeprint", () => paper(true));
  addEventListener("afterprint", () => paper(false));
  const arrive = () => show(decodeURIComponent(location.hash.slice(1)));
  addEventListener("hashchange", arrive);
  // The editor names the line at its cursor: `{file, line}`, the line counted from 1.
  addEventListener("message", ({ data: message }) => {
    for (const side of editor ? sides : []) {
      const source = Object.keys(side.files).find((number) => side.files[number] === message.file);
      if (source !== undefined) show(`${side.word}-${source}-${message.line}`);
    }
  });
  if (editor) viewer.drawn = () => editor.setState(viewer.camera);
  measure();
  if (!editor) look("first");
  arrive();
})();
