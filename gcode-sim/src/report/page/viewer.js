// The drawing: one camera for all canvases, in parallel projection.
const RAD = Math.PI / 180;
// Largest distance of a drawn line from the path, pixels, and largest number of letters of the exact path that replaces the lines.
const MOST_PIXELS = 0.3;
const MOST_LETTERS = 1.6e6;
// Height of the strip for the scale bar below the drawing, pixels.
const STRIP = 40;
// Half the length of the cross in place of a ring that is wider than the canvas, pixels.
const CROSS = 10;
// Width of a printed page, pixels; the style sheet has the heights of the canvases there.
const PAPER_WIDTH = 703;
// Half the width of a ring that has room for names inside, pixels.
const BIG = 60;
// Distances of a name from its hole beyond the closest, pixels; farther off it is on a line.
const LEADERS = [0, 10, 22, 36];
// Number of shades of the feeds by their height.
const SHADES = 6;

class Camera {
  constructor(up) {
    this.up = up;
    this.scale = 1;
    this.look("reset");
  }

  // Named views. The axis `up` is z or y; with y, x points to the right and -z away from the viewer.
  look(name) {
    const [yaw, pitch] = { top: [0, 90], front: [0, 0], side: [90, 0], reset: [-30, 28] }[name];
    Object.assign(this, { yaw, pitch, zoom: 1, offset: [0, 0, 0] });
  }

  turn(yaw, pitch) {
    this.yaw = (this.yaw + yaw) % 360;
    this.pitch = Math.max(-90, Math.min(90, this.pitch + pitch));
  }

  // Moves the picture by pixels. The point in the middle of the canvas, about which it rotates, has an offset from that of the part.
  pan(dx, dy) {
    const [right, up] = this.axes();
    this.offset = this.offset.map((mm, axis) => mm - (dx * right[axis] - dy * up[axis]) / this.scale);
  }

  // Zooms about a point of the canvas, given from its middle, that stays where it is.
  magnify(factor, x = 0, y = 0) {
    const zoom = Math.max(0.2, Math.min(1e5, this.zoom * factor));
    const by = zoom / this.zoom;
    this.zoom = zoom;
    this.scale *= by;
    this.pan(x * (1 - by), y * (1 - by));
  }

  // Rows: right, up, towards the viewer.
  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw * RAD), Math.sin(this.yaw * RAD), Math.cos(this.pitch * RAD), Math.sin(this.pitch * RAD)];
    const rows = [[cy, sy, 0], [-sy * sp, cy * sp, cp], [sy * cp, -cy * cp, sp]];
    return this.up === "z" ? rows : rows.map(([a, b, c]) => [a, c, -b]);
  }
}

// Reads the points of a path: differences of x, y, z in 0.0001 mm, in base64, 7 bits a byte, the lowest first.
function exactPoints(text) {
  const bytes = atob(text);
  const points = [];
  const last = [0, 0, 0];
  for (let at = 0, axis = 0; at < bytes.length; axis = (axis + 1) % 3) {
    let [number, place, byte] = [0, 1, 0];
    do {
      byte = bytes.charCodeAt(at++);
      number += (byte & 127) * place;
      place *= 128;
    } while (byte & 128);
    last[axis] += number % 2 ? -(number + 1) / 2 : number / 2;
    points.push(last[axis] / 1e4);
  }
  return Float64Array.from(points);
}

class Side {
  // The scene has polylines with a pen, one for each move, and marks with a status, one for each hole.
  constructor({ scene, holes, changed, ...data }, canvas) {
    Object.assign(this, data, { canvas, context: canvas.getContext("2d"), moves: scene.strokes });
    this.starts = new Uint32Array(this.moves.length + 1);
    this.moves.forEach(({ line }, move) => (this.starts[move + 1] = this.starts[move] + line.length / 3));
    // The point at which the known path begins: a move with an unknown end is one point.
    const known = this.moves.findIndex(({ line }) => 3 < line.length);
    this.first = known < 0 ? this.starts[this.moves.length] - 1 : this.starts[known];
    // The last move ends at an unknown place.
    this.isLost = ["end", "both"].includes(this.unplaced[this.moves.length - 1]);
    this.xyz = Float64Array.from(this.moves.flatMap(({ line }) => line));
    this.isChanged = new Set(changed);
    // Exact points by move, and those in sight on the canvas.
    this.known = new Map();
    this.sharp = new Map();
    this.screen = new Float32Array((2 * this.xyz.length) / 3);
    this.holes = scene.marks.map(({ position, direction, depth = 0, ...mark }, index) => ({
      ...mark,
      ...holes[index],
      id: mark.label[0],
      entry: position,
      bottom: position.map((mm, axis) => mm - depth * direction[axis]),
      axis: direction,
      depth,
    }));
  }

  // Coordinates of cuts and holes, or of all moves if there are none.
  extent() {
    const points = this.holes.flatMap((hole) => [...hole.entry, ...hole.bottom]);
    const take = (matches) => {
      for (let move = 0; move < this.moves.length; move++) {
        if (!matches(this.moves[move].pen)) continue;
        for (let at = 3 * this.starts[move]; at < 3 * this.starts[move + 1]; at++) points.push(this.xyz[at]);
      }
    };
    take((pen) => pen !== "rapid");
    if (points.length === 0) take(() => true);
    return points;
  }

  // Projects a point of the part to the canvas.
  point([x, y, z]) {
    const [right, up] = this.view.rows;
    const { middle, scale, cx, cy } = this.view;
    const [a, b, c] = [x - middle[0], y - middle[1], z - middle[2]];
    return [cx + scale * (right[0] * a + right[1] * b + right[2] * c), cy - scale * (up[0] * a + up[1] * b + up[2] * c)];
  }

  project(view) {
    this.view = view;
    const [r, u] = view.rows;
    const [mx, my, mz] = view.middle;
    for (let i = 0, j = 0; j < this.screen.length; i += 3, j += 2) {
      const [a, b, c] = [this.xyz[i] - mx, this.xyz[i + 1] - my, this.xyz[i + 2] - mz];
      this.screen[j] = view.cx + view.scale * (r[0] * a + r[1] * b + r[2] * c);
      this.screen[j + 1] = view.cy - view.scale * (u[0] * a + u[1] * b + u[2] * c);
    }
    this.sharpen();
  }

  // Finds the moves in sight whose lines are visibly off the path, and projects their exact points.
  sharpen() {
    this.sharp.clear();
    const { width, height, scale } = this.view;
    const reach = this.deviation * scale;
    if (reach < MOST_PIXELS) return;
    const moves = [];
    let letters = 0;
    for (let move = 0; move < this.moves.length; move++) {
      if (!this.exact[move]) continue;
      let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
      for (let at = 2 * this.starts[move]; at < 2 * this.starts[move + 1]; at += 2) {
        left = Math.min(left, this.screen[at]);
        right = Math.max(right, this.screen[at]);
        top = Math.min(top, this.screen[at + 1]);
        bottom = Math.max(bottom, this.screen[at + 1]);
      }
      if (right + reach < 0 || width < left - reach || bottom + reach < 0 || height < top - reach) continue;
      moves.push(move);
      letters += this.exact[move].length;
      if (MOST_LETTERS < letters) return;
    }
    if (4000 < this.known.size) this.known.clear();
    for (const move of moves) {
      if (!this.known.has(move)) this.known.set(move, exactPoints(this.exact[move]));
      const points = this.known.get(move);
      const screen = new Float32Array((2 * points.length) / 3);
      for (let at = 0; at < points.length; at += 3) {
        screen.set(this.point([points[at], points[at + 1], points[at + 2]]), (2 * at) / 3);
      }
      this.sharp.set(move, screen);
    }
  }

  // Returns a place on the screen as pixels from the middle of the drawing.
  fromMiddle(x, y) {
    const box = this.canvas.getBoundingClientRect();
    return [x - box.left - this.canvas.clientLeft - this.view.cx, y - box.top - this.canvas.clientTop - this.view.cy];
  }

  // Points of a move on the canvas, and the range of its coordinates.
  line(move) {
    const sharp = this.sharp.get(move);
    return sharp ? [sharp, 0, sharp.length] : [this.screen, 2 * this.starts[move], 2 * this.starts[move + 1]];
  }

  strokeMoves(colour, width, dash, matches, context = this.context) {
    Object.assign(context, { strokeStyle: colour, lineWidth: width });
    context.setLineDash(dash);
    let drawn = 0;
    context.beginPath();
    for (let move = 0; move < this.moves.length; move++) {
      if (!matches(move)) continue;
      const [points, first, end] = this.line(move);
      context.moveTo(points[first], points[first + 1]);
      for (let at = first + 2; at < end; at += 2) context.lineTo(points[at], points[at + 1]);
      // Long paths are slow to stroke.
      if (++drawn % 1000 === 0) {
        context.stroke();
        context.beginPath();
      }
    }
    context.stroke();
    context.setLineDash([]);
  }

  // Returns the shade of each stretch of a move by the height of its middle.
  shades(move) {
    const exact = this.sharp.has(move) ? this.known.get(move) : null;
    const [points, first, end] = exact ? [exact, 0, exact.length] : [this.xyz, 3 * this.starts[move], 3 * this.starts[move + 1]];
    const [low, high] = this.heights;
    const shades = [];
    for (let at = first + "xyz".indexOf(this.up); at < end - 3; at += 3) {
      const part = ((points[at] + points[at + 3]) / 2 - low) / (high - low);
      shades.push(Math.max(0, Math.min(SHADES - 1, Math.floor(SHADES * part))));
    }
    return shades;
  }

  // Draws feeds, each stretch in the shade of its height where they differ in height.
  strokeFeeds(colours, width, matches) {
    if (!this.heights) return this.strokeMoves(colours.feed, width, [], matches);
    const context = this.context;
    const paths = Array.from({ length: SHADES }, () => new Path2D());
    let drawn = 0;
    const stroke = () => paths.forEach((path, shade) => {
      context.strokeStyle = colours[`depth-${shade}`];
      context.stroke(path);
      paths[shade] = new Path2D();
    });
    context.lineWidth = width;
    for (let move = 0; move < this.moves.length; move++) {
      if (!matches(move)) continue;
      const [points, first, end] = this.line(move);
      let before = null;
      this.shades(move).forEach((shade, stretch) => {
        const at = first + 2 * stretch;
        if (shade !== before) paths[shade].moveTo(points[at], points[at + 1]);
        if (at + 3 < end) paths[shade].lineTo(points[at + 2], points[at + 3]);
        before = shade;
      });
      if (++drawn % 1000 === 0) stroke();
    }
    stroke();
  }

  draw(colours, options, pick, other) {
    const context = this.context;
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    // Dashes of a line much longer than the canvas are slow.
    const few = this.moves.length < 5000 && this.view.zoom < 200;
    this.drawStock(colours);
    const { upTo } = options;
    if (upTo !== null) {
      // The moves that follow are faint, each in the pen of its kind.
      const follows = (pen) => (move) => move >= upTo && this.moves[move].pen === pen;
      context.globalAlpha = 0.3;
      if (options.rapids) this.strokeMoves(colours.rapid, 1, few ? [5, 4] : [], follows("rapid"));
      this.strokeFeeds(colours, 1, follows("feed"));
      this.strokeMoves(colours.probe, 1, [2, 3], follows("probe"));
      context.globalAlpha = 1;
    }
    const shown = (move) => (!options.changedOnly || this.isChanged.has(move)) && (upTo === null || move < upTo);
    const plain = (pen) => (move) => shown(move) && this.moves[move].pen === pen && !this.isChanged.has(move);
    if (options.rapids) this.strokeMoves(colours.rapid, 1, few ? [5, 4] : [], plain("rapid"));
    this.strokeFeeds(colours, 1.6, plain("feed"));
    this.strokeMoves(colours.probe, 2, [2, 3], plain("probe"));
    const rapid = (move) => this.moves[move].pen === "rapid";
    if (options.rapids) this.strokeMoves(colours.changed, few ? 2 : 0.8, few ? [5, 4] : [], (move) => this.isChanged.has(move) && rapid(move));
    this.strokeMoves(colours.changed, few ? 3.5 : 1.2, [], (move) => this.isChanged.has(move) && !rapid(move));
    // What the other program does instead, faint.
    if (other) {
      context.globalAlpha = 0.6;
      other.strokeMoves(colours.changed, 1, few ? [2, 3] : [], (move) => other.isChanged.has(move) && !(other.moves[move].pen === "rapid"), context);
      context.globalAlpha = 1;
    }
    const line = pick.line?.side === this ? pick.line.number : null;
    if (line !== null) this.strokeMoves(colours.pick, 4, [], (move) => shown(move) && this.places[this.at[move]].includes(line));
    if (pick.side === this && pick.move !== undefined) {
      this.strokeMoves(colours.pick, 5, [], (move) => move === pick.move);
    }
    this.drawHoles(colours, pick);
    this.drawZeros(colours);
    this.drawEnds(colours, this.isLost || (this.ends_with_alarm && upTo === null));
    if (this.ends_with_alarm && upTo === null) this.drawAlarm(colours);
    if (upTo !== null) this.drawTool(colours, upTo);
    this.drawAxes(colours);
    if (this.overview) this.drawOverview(colours);
  }

  // Returns the work zeros on the canvas; those in one place have their names in one line.
  zeroPlaces() {
    const places = [];
    for (const [name, at] of this.zeros) {
      const [x, y] = this.point(at);
      const same = places.find((place) => Math.hypot(place.x - x, place.y - y) < 8);
      if (same) same.name += `, ${name}`;
      else places.push({ x, y, name });
    }
    return places;
  }

  // Draws the work zeros: a circle with two black quarters.
  drawZeros(colours) {
    const context = this.context;
    for (const { x, y } of this.zeroPlaces()) {
      Object.assign(context, { strokeStyle: colours.ink, fillStyle: colours.paper, lineWidth: 1.5 });
      context.beginPath();
      context.arc(x, y, 8, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      context.fillStyle = colours.ink;
      for (const from of [-Math.PI / 2, Math.PI / 2]) {
        context.beginPath();
        context.moveTo(x, y);
        context.arc(x, y, 8, from, from + Math.PI / 2);
        context.fill();
      }
    }
  }

  // Returns where a point of the path is marked: beyond the canvas at its edge, clear of the caption and of the scale bar.
  inside(at) {
    const { width, height } = this.view;
    const seen = [this.screen[at], this.screen[at + 1]];
    const [x, y] = [Math.max(10, Math.min(width - 10, seen[0])), Math.max(10, Math.min(height - 10, seen[1]))];
    if (x === seen[0] && y === seen[1]) return seen;
    if (this.focus && y < 30 && x < 0.6 * width) return [x, 36];
    return [x, x > width - 145 && y > height - 36 ? height - 46 : y];
  }

  // Returns where start and end of the path are marked: beside a ring, a work zero or each other, so that both are seen.
  ends() {
    if (this.moves.length === 0) return [];
    const points = [2 * this.first, 2 * (this.starts[this.moves.length] - 1)];
    const rings = this.holes.length > 500 ? [] : this.holes.filter((hole) => !this.isBeyond(hole));
    const taken = rings.map((hole) => [...this.point(hole.entry), Math.max(...this.reach(hole))]).filter(([, , reach]) => reach < BIG);
    for (const { x, y } of this.zeroPlaces()) taken.push([x, y, 8]);
    return points.map((at) => {
      const [x, y] = this.inside(at);
      const isOutside = x !== this.screen[at] || y !== this.screen[at + 1];
      const over = taken.find(([a, b, reach]) => Math.hypot(x - a, y - b) < reach + 4);
      const beside = ([dx, dy]) => [over[0] + dx * (over[2] + 8), over[1] + dy * (over[2] + 8)];
      const isFree = ([a, b]) => taken.every(([c, d, reach]) => Math.hypot(a - c, b - d) > reach + 7);
      // Beyond the canvas, start and end are beside each other on its edge.
      const ways = isOutside ? [[1, 0], [-1, 0], [0, 1], [0, -1]] : [[-0.7, 0.7], [0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]];
      const isInside = ([a, b]) => a > 9 && b > 9 && a < this.view.width - 9 && b < this.view.height - 9;
      const place = (over ? ways.map(beside).find((at) => isFree(at) && isInside(at)) : null) ?? [x, y];
      taken.push([...place, 7]);
      return [...place, isOutside];
    });
  }

  // Marks the start of the path by a triangle and, unless an alarm ends it or its place is unknown, its end by a square: holes
  // are rings.
  drawEnds(colours, hasNoEnd) {
    if (this.moves.length === 0) return;
    const context = this.context;
    Object.assign(context, { strokeStyle: colours.paper, fillStyle: colours.ink, lineWidth: 1.5 });
    const [[startX, startY, isStartOutside], [endX, endY, isEndOutside]] = this.ends();
    context.beginPath();
    if (!hasNoEnd) context.rect(endX - 5, endY - 5, 10, 10);
    context.stroke();
    context.fill();
    // Open, so that it is seen on the black quarters of a work zero.
    context.beginPath();
    context.moveTo(startX - 5, startY - 7);
    context.lineTo(startX + 8, startY);
    context.lineTo(startX - 5, startY + 7);
    context.closePath();
    context.fillStyle = colours.paper;
    for (const [strokeStyle, lineWidth] of [[colours.paper, 6], [colours.ink, 2]]) {
      Object.assign(context, { strokeStyle, lineWidth });
      context.stroke();
      context.fill();
    }
    Object.assign(context, { font: "12px system-ui, sans-serif", fillStyle: colours.ink });
    const outside = [];
    if (isStartOutside) outside.push(["start", startX, startY]);
    if (isEndOutside && !hasNoEnd) outside.push(["end", endX, endY]);
    // Side by side they have one line.
    const [first, second] = outside;
    const isOneLine = second && Math.abs(first[1] - second[1]) < 130 && Math.abs(first[2] - second[2]) < 14;
    const texts = isOneLine ? [["start, end", Math.max(first[1], second[1]), first[2], Math.min(first[1], second[1])]] : outside;
    for (const [name, x, y, left = x] of texts) {
      const words = `${name} (outside)`;
      const isRight = x + 14 + context.measureText(words).width > this.view.width;
      context.textAlign = isRight ? "right" : "left";
      this.write(words, isRight ? left - 12 : x + 12, y + 4, colours);
      context.textAlign = "left";
    }
  }

  // Draws the whole part small in a corner, with a cross at the place that the drawing shows larger.
  drawOverview(colours) {
    const { rows, middle, width, height, zoom } = this.view;
    const [wide, high] = [Math.min(150, 0.3 * width), Math.min(105, 0.3 * height)];
    if (zoom < 4) return;
    const { factor, centre } = this.overview(rows, wide, high);
    const [left, top] = [width - wide - 8, 8];
    const context = this.context;
    Object.assign(context, { fillStyle: colours.paper, strokeStyle: colours.soft, lineWidth: 1 });
    context.fillRect(left, top, wide, high);
    context.strokeRect(left, top, wide, high);
    const place = (at) => {
      const off = at.map((mm, axis) => mm - centre[axis]);
      const seen = [0, 1].map((row) => rows[row].reduce((sum, part, axis) => sum + part * off[axis], 0));
      return [left + wide / 2 + factor * seen[0], top + high / 2 - factor * seen[1]];
    };
    context.save();
    context.beginPath();
    context.rect(left, top, wide, high);
    context.clip();
    context.strokeStyle = colours.feed;
    context.beginPath();
    const step = Math.max(1, Math.ceil(this.moves.length / 4000));
    for (let move = 0; move < this.moves.length; move += step) {
      if (this.moves[move].pen === "rapid") continue;
      for (let at = this.starts[move]; at < this.starts[move + 1]; at++) {
        const [x, y] = place([...this.xyz.slice(3 * at, 3 * at + 3)]);
        if (at === this.starts[move]) context.moveTo(x, y);
        else context.lineTo(x, y);
      }
    }
    context.stroke();
    context.strokeStyle = colours.hole;
    context.beginPath();
    for (const hole of this.holes) {
      const [[x, y], radius] = [place(hole.entry), Math.max(1.5, hole.radius * factor)];
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
    context.stroke();
    const [x, y] = place(middle);
    Object.assign(context, { strokeStyle: colours.pick, lineWidth: 2 });
    context.beginPath();
    for (const [dx, dy] of [[9, 0], [0, 9]]) {
      context.moveTo(x - dx, y - dy);
      context.lineTo(x + dx, y + dy);
    }
    context.stroke();
    context.restore();
    Object.assign(context, { font: "12px system-ui, sans-serif", fillStyle: colours.ink });
    if (this.focus) this.write(this.focus, 8, 18, colours);
  }

  drawStock(colours) {
    const context = this.context;
    Object.assign(context, { strokeStyle: colours.soft, lineWidth: 1 });
    context.beginPath();
    for (const edge of this.stock) {
      context.moveTo(...this.point(edge[0]));
      edge.slice(1).forEach((point) => context.lineTo(...this.point(point)));
    }
    context.stroke();
  }

  // Marks the end of the path by a cross; one at the edge of the canvas says that the place is beyond it.
  drawAlarm(colours) {
    if (this.moves.length === 0) return;
    const at = 2 * (this.starts[this.moves.length] - 1);
    const [x, y] = this.inside(at);
    const context = this.context;
    if (x !== this.screen[at] || y !== this.screen[at + 1]) {
      Object.assign(context, { font: "12px system-ui, sans-serif", fillStyle: colours.wrong });
      const words = "stopped (outside)";
      this.write(words, x < this.view.width / 2 ? x + 13 : x - 13 - context.measureText(words).width, y + 4, colours);
    }
    for (const [strokeStyle, lineWidth] of [[colours.paper, 6], [colours.wrong, 3]]) {
      Object.assign(context, { strokeStyle, lineWidth });
      context.beginPath();
      for (const slope of [1, -1]) {
        context.moveTo(x - 8, y - 8 * slope);
        context.lineTo(x + 8, y + 8 * slope);
      }
      context.stroke();
    }
  }

  // Marks where the tool stands after a number of moves.
  drawTool(colours, upTo) {
    if (this.moves.length === 0) return;
    const at = 2 * Math.max(this.first, this.starts[upTo] - 1);
    const context = this.context;
    Object.assign(context, { strokeStyle: colours.paper, fillStyle: colours.pick, lineWidth: 2 });
    context.beginPath();
    context.arc(this.screen[at], this.screen[at + 1], 6, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }

  // Whether the entry of a hole faces away from the viewer.
  isAway(hole) {
    const near = this.view.rows[2];
    return [0, 1, 2].reduce((sum, axis) => sum + near[axis] * (hole.entry[axis] - hole.bottom[axis]), 0) < -1e-9;
  }

  drawHoles(colours, pick) {
    const isPicked = (hole) => hole === pick.hole || (hole.row !== null && hole.row === pick.row);
    const wrong = (hole) => ["bad", "extra", "missing"].includes(hole.status);
    const kind = (hole) => (isPicked(hole) ? "pick" : wrong(hole) ? "wrong" : "hole");
    const groups = new Map();
    for (const hole of this.holes) {
      const name = `${this.isAway(hole) ? "a" : "b"} ${kind(hole)} ${hole.status === "missing"}`;
      if (!groups.has(name)) groups.set(name, []);
      groups.get(name).push(hole);
    }
    const context = this.context;
    const many = this.holes.length > 500;
    // Holes that face away are drawn first and faint, good ones before bad ones.
    const order = (name) => [name[0], ["hole", "wrong", "pick"].indexOf(name.split(" ")[1])].join("");
    for (const name of [...groups.keys()].sort((a, b) => (order(a) < order(b) ? -1 : 1))) {
      const [away, role, isMissing] = name.split(" ");
      const style = { globalAlpha: away === "a" && role === "hole" ? 0.3 : 1, strokeStyle: colours[role], fillStyle: colours[role] };
      Object.assign(context, style, { lineWidth: role === "pick" ? 3 : many ? 0.8 : 1.5 });
      context.setLineDash(isMissing === "true" ? [3, 3] : []);
      this.strokeHoles(groups.get(name), role !== "hole");
      context.setLineDash([]);
    }
    // The most important labels are placed first, clear of the marks and of the rings that are no frames for them.
    const taken = this.marked();
    for (const hole of this.holes) {
      const [x, y] = this.point(hole.entry);
      const [wide, high] = this.reach(hole);
      if (wide < BIG && high < BIG) taken.push([x - wide, y - high, x + wide, y + high]);
    }
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = colours.ink;
    for (const { x, y, name } of this.zeroPlaces()) this.label(name, [x, y], [9, 9], taken, colours, false);
    for (const name of [...groups.keys()].sort((a, b) => (order(a) < order(b) ? 1 : -1))) {
      const [away, role] = name.split(" ");
      Object.assign(context, { globalAlpha: away === "a" && role === "hole" ? 0.3 : 1, fillStyle: colours[role] });
      const group = groups.get(name);
      // Names in a crowd would be ambiguous.
      const named = this.holes.length <= 60 || (role !== "hole" && group.length <= 60) || role === "pick";
      if (named) group.forEach((hole) => this.label(hole.id, this.point(hole.entry), this.reach(hole), taken, colours, role === "pick"));
    }
    context.globalAlpha = 1;
  }

  // Returns the boxes of start, end and work zeros on the canvas: left, top, right, bottom.
  marked() {
    const ends = this.ends().slice(0, this.isLost ? 1 : 2);
    const places = [...ends, ...this.zeros.map(([, at]) => this.point(at))];
    return places.map(([x, y]) => [x - 9, y - 9, x + 9, y + 9]);
  }

  // Half the width and the height of a hole's ring on the canvas.
  reach(hole) {
    const [along, across, angle] = this.isBeyond(hole) ? [CROSS, CROSS, 0] : this.ring(hole, this.radius(hole));
    const half = (one, other) => Math.hypot(along * one, across * other);
    return [half(Math.cos(angle), Math.sin(angle)), half(Math.sin(angle), Math.cos(angle))];
  }

  // Writes the name of a hole or a work zero at the first free position: close to it, else farther off on a line. Without one, a click
  // on the hole shows it.
  label(name, [x, y], [along, rise], taken, colours, always) {
    const [wide, high] = [this.context.measureText(name).width, 12];
    // Above to the right and the left, beside, below, and centred above and below.
    const around = (off) => {
      const [right, left, middle] = [x + along + 4 + off, x - along - 4 - wide - off, x - wide / 2];
      return [
        [right, y - rise + 2 - off], [left, y - rise + 2 - off], [right, y + high / 2 - 2], [left, y + high / 2 - 2],
        [right, y + rise + high - 4 + off], [left, y + rise + high - 4 + off], [middle, y - rise - 4 - off], [middle, y + rise + high + 2 + off],
      ];
    };
    const places = LEADERS.flatMap(around);
    const box = ([at, bottom]) => [at, bottom - high + 2, at + wide, bottom + 2];
    const isFree = (place) => {
      const [from, top, to, bottom] = box(place);
      if (from < 0 || top < 0 || this.view.width < to || this.view.height < bottom) return false;
      return taken.every((other) => to < other[0] || other[2] < from || bottom < other[1] || other[3] < top);
    };
    const place = places.find(isFree) ?? (always ? places[0] : null);
    if (!place) return;
    taken.push(box(place));
    if (places.indexOf(place) >= 8) {
      const [from, top, to, bottom] = box(place);
      const end = [Math.max(from, Math.min(to, x)), Math.max(top, Math.min(bottom, y))];
      Object.assign(this.context, { strokeStyle: colours.soft, lineWidth: 0.8 });
      this.context.beginPath();
      this.context.moveTo(x, y);
      this.context.lineTo(...end);
      this.context.stroke();
    }
    this.write(name, ...place, colours);
  }

  // Writes a text with a margin that interrupts lines.
  write(words, x, y, colours) {
    Object.assign(this.context, { strokeStyle: colours.paper, lineWidth: 3, lineJoin: "round" });
    this.context.strokeText(words, x, y);
    this.context.fillText(words, x, y);
  }

  radius(hole) {
    return Math.max(this.holes.length > 500 ? 1.5 : 3, hole.radius * this.view.scale);
  }

  // The ring of a hole on the canvas, from its pixels of radius: half axes along and across the hole's axis, and the angle of that.
  ring(hole, radius) {
    const [right, up, near] = this.view.rows.map((row) => row.reduce((sum, part, axis) => sum + part * hole.axis[axis], 0));
    return [radius * Math.min(1, Math.abs(near)), radius, Math.atan2(-up, right)];
  }

  // Whether the ring of a hole is wider than the canvas.
  isBeyond(hole) {
    return this.radius(hole) > Math.hypot(this.view.width, this.view.height) / 2;
  }

  strokeHoles(holes, ringed) {
    const context = this.context;
    context.beginPath();
    for (const hole of holes) {
      const [x, y] = this.point(hole.entry);
      context.moveTo(x, y);
      context.lineTo(...this.point(hole.bottom));
      if (this.isBeyond(hole)) {
        for (const [dx, dy] of [[CROSS, 0], [0, CROSS]]) {
          context.moveTo(x - dx, y - dy);
          context.lineTo(x + dx, y + dy);
        }
        continue;
      }
      for (const radius of ringed ? [this.radius(hole), this.radius(hole) + 4] : [this.radius(hole)]) {
        const [along, across, angle] = this.ring(hole, radius);
        context.moveTo(x + along * Math.cos(angle), y + along * Math.sin(angle));
        context.ellipse(x, y, along, across, angle, 0, 2 * Math.PI);
      }
    }
    context.stroke();
  }

  // Draws the part's axes and a scale bar.
  drawAxes(colours) {
    const context = this.context;
    const { width, height, rows, scale } = this.view;
    const [ox, oy] = [42, height - 42];
    Object.assign(context, { strokeStyle: colours.ink, fillStyle: colours.ink, lineWidth: 1.5, font: "12px system-ui, sans-serif" });
    ["X", "Y", "Z"].forEach((name, axis) => {
      const [dx, dy] = [28 * rows[0][axis], -28 * rows[1][axis]];
      context.beginPath();
      context.moveTo(ox, oy);
      context.lineTo(ox + dx, oy + dy);
      context.stroke();
      if (Math.hypot(dx, dy) > 6) this.write(name, ox + 1.3 * dx - 4, oy + 1.3 * dy + 4, colours);
      Object.assign(context, { strokeStyle: colours.ink, lineWidth: 1.5 });
    });
    const decade = 10 ** Math.floor(Math.log10(120 / scale));
    const length = [5, 2, 1].map((step) => step * decade).find((mm) => mm * scale <= 120) ?? decade;
    const [right, bottom] = [width - 12, height - 12];
    context.beginPath();
    context.moveTo(right - length * scale, bottom - 5);
    context.lineTo(right - length * scale, bottom);
    context.lineTo(right, bottom);
    context.lineTo(right, bottom - 5);
    context.stroke();
    context.textAlign = "right";
    this.write(`${Number(length.toPrecision(3))} mm`, right, bottom - 8, colours);
    context.textAlign = "left";
  }

  // Returns the hole, else the move, under a point of the canvas.
  nearest(x, y, options) {
    const reach = 12;
    let best = null;
    for (const hole of this.holes) {
      const near = toSegment(x, y, ...this.point(hole.entry), ...this.point(hole.bottom));
      // A hole that faces away lies behind others.
      const far = near + (this.isAway(hole) ? reach / 2 : 0);
      if (far < Math.max(reach, this.radius(hole)) && (!best || far < best.far)) best = { far, hole, side: this };
    }
    if (best) return best;
    for (let move = 0; move < this.moves.length; move++) {
      if ((!options.rapids && this.moves[move].pen === "rapid") || (options.changedOnly && !this.isChanged.has(move))) continue;
      const [points, first, end] = this.line(move);
      for (let at = first; at < end - 2; at += 2) {
        const far = toSegment(x, y, points[at], points[at + 1], points[at + 2], points[at + 3]);
        // The later of two coincident moves is on top.
        if (far < reach && (!best || far <= best.far)) best = { far, move, side: this, part: (at - first) / 2 };
      }
    }
    return best;
  }
}

function toSegment(x, y, ax, ay, bx, by) {
  const [dx, dy] = [bx - ax, by - ay];
  const part = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - ax - part * dx, y - ay - part * dy);
}

// Fits the extents into the canvases, and draws after changes.
class Viewer {
  constructor(data, sides) {
    sides.forEach((side) => Object.assign(side, { stock: data.stock, zeros: data.zeros, heights: data.heights, up: data.up }));
    Object.assign(this, { sides, camera: new Camera(data.up), pick: {}, options: { rapids: true, changedOnly: false, upTo: null } });
    this.extents = [...sides.flatMap((side) => side.extent()), ...data.stock.flat(2)];
    if (sides.length === 2) sides.forEach((side) => (side.overview = (...box) => this.whole(...box)));
    this.middle = [0, 1, 2].map((axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (let at = axis; at < this.extents.length; at += 3) {
        low = Math.min(low, this.extents[at]);
        high = Math.max(high, this.extents[at]);
      }
      return low <= high ? (low + high) / 2 : 0;
    });
    this.waiting = false;
  }

  // Returns the pixels per millimetre that fit the extents into the canvas.
  fitting(rows, width, height) {
    if (this.extents.length === 0) return 1;
    let [wide, high] = [1e-3, 1e-3];
    for (let at = 0; at < this.extents.length; at += 3) {
      const [a, b, c] = [0, 1, 2].map((axis) => this.extents[at + axis] - this.middle[axis]);
      wide = Math.max(wide, Math.abs(rows[0][0] * a + rows[0][1] * b + rows[0][2] * c));
      high = Math.max(high, Math.abs(rows[1][0] * a + rows[1][1] * b + rows[1][2] * c));
    }
    return Math.min((0.42 * width) / wide, (0.42 * (height - STRIP)) / high);
  }

  // Looks at the change, else at all: at the largest displacement of a hole, or at the first cut that differs.
  first() {
    this.camera.look("reset");
    const change = this.sides.length === 2 ? this.displacement() : null;
    this.sides.forEach((side) => (side.focus = null));
    if (!change) return;
    const { ends: [from, to], hole, where } = change;
    const way = to.map((mm, axis) => mm - from[axis]);
    const length = Math.hypot(...way);
    // A displacement along the upright axis is seen from the front, another from above.
    this.camera.look(Math.abs(way["xyz".indexOf(this.camera.up)]) > 0.7 * length ? "front" : "top");
    const rows = this.camera.axes();
    const fitting = Math.min(...this.sides.map(({ canvas }) => this.fitting(rows, canvas.clientWidth, canvas.clientHeight)));
    if (!(fitting > 0)) return;
    const text = `${hole ? `hole ${hole.id}, ${where}: ` : "first cut that differs: "}${Number(length.toPrecision(3))} mm apart`;
    this.sides.forEach((side) => (side.focus = text));
    // It spans 40 pixels, so that 0.05 mm are seen as well as 50.
    this.camera.zoom = Math.max(1, Math.min(1e5, 40 / length / fitting));
    this.camera.offset = from.map((mm, axis) => (mm + to[axis]) / 2 - this.middle[axis]);
  }

  // Returns both ends of the largest displacement; null if nothing is displaced.
  displacement() {
    const [old, now] = this.sides;
    const rows = new Map(old.holes.filter((hole) => hole.row !== null).map((hole) => [hole.row, hole]));
    const far = ({ ends: [a, b] }) => Math.hypot(...a.map((mm, axis) => mm - b[axis]));
    const holes = now.holes.filter((hole) => rows.has(hole.row)).flatMap((hole) => {
      const before = rows.get(hole.row);
      return ["entry", "bottom"].map((where) => ({ ends: [before[where], hole[where]], hole, where }));
    });
    const end = (side, move) => [...side.xyz.slice(3 * side.starts[move + 1] - 3, 3 * side.starts[move + 1])];
    const cut = (side) => [...side.isChanged].find((move) => side.moves[move].pen !== "rapid");
    const cuts = [cut(old), cut(now)];
    const moves = cuts.every((move) => move !== undefined) ? [{ ends: [end(old, cuts[0]), end(now, cuts[1])] }] : [];
    const largest = [...holes, ...(holes.some((pair) => far(pair) > 1e-3) ? [] : moves)].sort((a, b) => far(b) - far(a))[0];
    return largest && far(largest) > 1e-3 ? largest : null;
  }

  // Returns scale and middle of the whole part in a box of this size.
  whole(rows, width, height) {
    return { factor: this.fitting(rows, width, height + STRIP), centre: this.middle };
  }

  // Returns width and height of a canvas in its pixels, and the dots of a pixel: on paper those of the printed page, whatever the
  // screen has.
  size(canvas) {
    if (this.isOnPaper) return [this.sides.length === 1 ? PAPER_WIDTH : PAPER_WIDTH / 2, this.sides.length === 1 ? 416 : 265, 3];
    return [canvas.clientWidth, canvas.clientHeight, window.devicePixelRatio || 1];
  }

  fit() {
    this.scales = null;
    this.ask();
  }

  ask() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.waiting = false;
    const style = getComputedStyle(document.documentElement);
    const names = ["paper", "ink", "soft", "rapid", "feed", "probe", "changed", "hole", "wrong", "pick"];
    for (let shade = 0; shade < SHADES; shade++) names.push(`depth-${shade}`);
    const colours = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
    const rows = this.camera.axes();
    this.scales ??= this.sides.map(({ canvas }) => this.fitting(rows, ...this.size(canvas)));
    const fitting = Math.min(...this.scales);
    const scale = fitting * this.camera.zoom;
    this.camera.scale = scale;
    const middle = this.middle.map((mm, axis) => mm + this.camera.offset[axis]);
    for (const side of this.sides) {
      const [width, height, dots] = this.size(side.canvas);
      if (!width || !height) continue;
      if (side.canvas.width !== Math.round(width * dots) || side.canvas.height !== Math.round(height * dots)) {
        side.canvas.width = Math.round(width * dots);
        side.canvas.height = Math.round(height * dots);
      }
      side.context.setTransform(dots, 0, 0, dots, 0, 0);
      side.project({ rows, middle, scale, width, height, zoom: this.camera.zoom, cx: width / 2, cy: (height - STRIP) / 2 });
    }
    const drawn = this.sides.filter((side) => side.view && this.size(side.canvas).every((length) => length > 0));
    for (const side of drawn) side.draw(colours, this.options, this.pick, drawn.find((other) => other !== side));
    this.drawn?.();
  }
}
