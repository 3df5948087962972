// Pictures that a reader explores: zoom and pan, values under the pointer, curves on and off, another variable.
// It works on the SVG of the page and on the samples beside it; without it the page is whole.
"use strict";
const NOTHING = 65535;
const STEP = 1.5; // zoom of one press or notch
const MARGIN = 0.04; // of a range that is fitted to its curves
const pictures = [];

function decoded([low, step, text]) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const codes = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 2 }, (_, k) => {
    const code = codes.getUint16(2 * k, true);
    return code === NOTHING ? NaN : low + code * step;
  });
}

// Multiples of 1, 2 or 5 times a power of ten, with their labels.
function ticks([low, high], count) {
  const raw = (high - low) / count;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * decade).find((s) => s >= raw) ?? 10 * decade;
  const decimals = Math.min(Math.max(-Math.floor(Math.log10(step) + 1e-9), 0), 9);
  const label = (v) => (step < 1e-6 || step >= 1e6 ? v.toExponential(1) : v.toFixed(decimals));
  const all = [];
  for (let k = Math.ceil(low / step); k <= Math.floor(high / step); k++) all.push([k * step, label(k * step)]);
  return all;
}

const rounded = (v) => String(Number(v.toPrecision(4))).replace("-", "\u2212");
// "joint speed, rad/s" is a name and its unit.
const named = (label) => label.match(/^(.*), ([^,]*)$/)?.slice(1) ?? [label, ""];
const same = (a, b) => a.every((v, k) => v === b[k]);

function make(tag, attributes, text) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text) element.textContent = text;
  return element;
}

class Picture {
  constructor(figure, number) {
    this.figure = figure;
    this.svg = figure.querySelector("svg");
    this.data = JSON.parse(figure.querySelector("script").textContent);
    this.columns = this.data.columns.map(decoded);
    this.paths = [...this.svg.querySelectorAll(".curves > path")];
    this.frame = this.svg.dataset.frame.split(" ").map(Number);
    this.hidden = new Set();
    this.view = this.data.views[0];
    this.range = [...this.view.range];
    this.clip(number);
  }

  // Curves end at the frame; what the pointer shows lies above them.
  clip(number) {
    const [left, top, right, floor] = this.frame;
    const box = `<rect x="${left}" y="${top}" width="${right - left}" height="${floor - top}"/>`;
    const mark = `<clipPath id="frame-${number}">${box}</clipPath><g class="pointer" aria-hidden="true"></g>`;
    this.svg.insertAdjacentHTML("beforeend", mark);
    this.svg.querySelector(".curves").setAttribute("clip-path", `url(#frame-${number})`);
    this.marks = this.svg.querySelector(".pointer");
    this.values = make("div", { class: "values", hidden: "", role: "status" });
    this.figure.append(this.values);
  }

  xy(curve) {
    return this.view.curves[curve].map((column) => this.columns[column]);
  }

  px([x, y]) {
    const [left, top, right, floor] = this.frame;
    const [x0, x1, y0, y1] = this.range;
    return [left + ((x - x0) / (x1 - x0)) * (right - left), floor - ((y - y0) / (y1 - y0)) * (floor - top)];
  }

  at([px, py]) {
    const [left, top, right, floor] = this.frame;
    const [x0, x1, y0, y1] = this.range;
    return [x0 + ((px - left) / (right - left)) * (x1 - x0), y0 + ((floor - py) / (floor - top)) * (y1 - y0)];
  }

  shown() {
    return this.data.curves.map((_, k) => k).filter((k) => !this.hidden.has(k));
  }

  // The range of y that shows what is between the ends of x; all of the picture as it was drawn.
  fit() {
    const [x0, x1] = this.range;
    if (!this.hidden.size && same([x0, x1], this.view.range)) {
      this.range = [...this.view.range];
      return;
    }
    let [low, high] = [Infinity, -Infinity];
    for (const k of this.shown()) {
      const [x, y] = this.xy(k);
      if (this.data.curves[k].kind === "stems") [low, high] = [Math.min(low, 0), Math.max(high, 0)];
      for (let i = 0; i < x.length; i++) {
        if (x[i] >= x0 && x[i] <= x1 && y[i] === y[i]) [low, high] = [Math.min(low, y[i]), Math.max(high, y[i])];
      }
    }
    if (low > high) return;
    const margin = high > low ? MARGIN * (high - low) : 0.5 * Math.max(Math.abs(low), 1);
    this.range = [x0, x1, low - margin, high + margin];
  }

  // Shows an interval of x, and with a time axis in every picture with a time axis that has something there; of y what
  // is given, else all.
  setX(low, high, y = null) {
    const [first, last] = this.view.range;
    const span = Math.min(Math.max(high - low, (last - first) / 2000), last - first);
    const from = Math.min(Math.max(low, first), last - span);
    const linked = this.view.time ? pictures.filter((p) => p.view.time) : [this];
    const all = span >= last - first;
    for (const picture of linked) {
      const whole = picture.view.range;
      const outside = from >= whole[1] || from + span <= whole[0];
      const interval = all || outside ? whole : [from, from + span];
      picture.range = [interval[0], interval[1], picture.range[2], picture.range[3]];
      picture.fit();
      if (picture === this && y) picture.range.splice(2, 2, ...y);
      picture.later();
    }
  }

  // What is not on the screen is drawn a moment later.
  later() {
    const { top, bottom } = this.svg.getBoundingClientRect();
    const seen = bottom > 0 && top < innerHeight;
    clearTimeout(this.timer);
    cancelAnimationFrame(this.request);
    if (seen) this.request = requestAnimationFrame(() => this.draw());
    else this.timer = setTimeout(() => this.draw(), 100);
  }

  zoom(factor, centre = (this.range[0] + this.range[1]) / 2) {
    const [x0, x1] = this.range;
    this.setX(centre - factor * (centre - x0), centre + factor * (x1 - centre));
  }

  pan(part, [low, high] = this.range) {
    const by = part * (high - low);
    this.setX(low + by, high + by);
  }

  reset() {
    this.setX(this.view.range[0], this.view.range[1]);
  }

  show(view) {
    this.view = view;
    this.range = [...view.range];
    const other = pictures.find((p) => p !== this && view.time && p.view.time);
    if (other && !same(other.range.slice(0, 2), other.view.range)) this.setX(other.range[0], other.range[1]);
    this.fit();
    this.draw();
  }

  path(k) {
    const [x, y] = this.xy(k);
    const { kind } = this.data.curves[k];
    const ground = this.px([0, 0])[1].toFixed(1);
    let [path, pen] = ["", false];
    for (let i = 0; i < x.length; i++) {
      const draws = y[i] === y[i]; // a gap is not a number
      if (draws) {
        const [px, py] = this.px([x[i], y[i]]).map((v) => v.toFixed(1));
        if (kind === "points") path += `M${px} ${py}h0`;
        else if (kind === "stems") path += `M${px} ${ground}V${py}`;
        else path += `${pen ? "L" : "M"}${px} ${py}`;
      }
      pen = draws;
    }
    return path;
  }

  draw() {
    const [left, top, right, floor] = this.frame;
    const [x0, x1, y0, y1] = this.range;
    const grid = (path, x, y, anchor, label) =>
      `<path class="grid" d="${path}"/><text x="${x}" y="${y}" text-anchor="${anchor}">${label}</text>`;
    this.svg.querySelector(".ticks.x").innerHTML = ticks([x0, x1], 7).map(([value, label]) => {
      const at = this.px([value, 0])[0].toFixed(1);
      return grid(`M${at} ${top}V${floor}`, at, floor + 17, "middle", label);
    }).join("");
    this.svg.querySelector(".ticks.y").innerHTML = ticks([y0, y1], 5).map(([value, label]) => {
      const at = this.px([0, value])[1];
      return grid(`M${left} ${at.toFixed(1)}H${right}`, left - 6, (at + 4).toFixed(1), "end", label);
    }).join("");
    this.svg.querySelector(".name.x").textContent = this.view.x;
    const bands = this.view === this.data.views[0] ? this.data.bands : [];
    this.svg.querySelector(".bands").innerHTML = bands.map((band) => {
      const [from, to] = band.map((edge) => Math.min(Math.max(this.px([edge, 0])[0], left), right));
      return `<rect class="band" x="${from}" y="${top}" width="${to - from}" height="${floor - top}"/>`;
    }).join("");
    this.paths.forEach((path, k) => path.setAttribute("d", this.hidden.has(k) ? "" : this.path(k)));
    this.leave();
  }

  // The sample of a curve that is nearest to a point of the picture: along x for a line, any way for points.
  nearest(k, [px, py]) {
    const [x, y] = this.xy(k);
    const cloud = this.data.curves[k].kind === "points";
    let [best, least] = [null, cloud ? 60 : 24];
    for (let i = 0; i < x.length; i++) {
      if (y[i] !== y[i]) continue;
      const [sx, sy] = this.px([x[i], y[i]]);
      const away = cloud ? Math.hypot(sx - px, sy - py) : Math.abs(sx - px);
      if (away < least) [best, least] = [i, away];
    }
    return best === null ? null : [x[best], y[best]];
  }

  // Reads every visible curve at a point of the picture.
  read(point) {
    const [left, top, right, floor] = this.frame;
    this.reading = [Math.min(Math.max(point[0], left), right), Math.min(Math.max(point[1], top), floor)];
    const found = this.shown().map((k) => [k, this.nearest(k, this.reading)]).filter(([, sample]) => sample);
    if (!found.length) return this.leave();
    const x = found[0][1][0];
    const [name, unit] = named(this.view.x);
    const yUnit = named(this.data.y)[1] || this.data.y;
    const across = this.px([x, 0])[0];
    this.marks.innerHTML = `<path class="ruler" d="M${across.toFixed(1)} ${top}V${floor}"/>` + found.map(([k, sample]) => {
      const [cx, cy] = this.px(sample);
      return cy < top || cy > floor ? "" : `<circle class="${this.data.curves[k].role}" cx="${cx.toFixed(1)}" cy="${cy.toFixed(1)}" r="4.5"/>`;
    }).join("");
    this.values.replaceChildren(make("div", {}, `${name} ${rounded(x)} ${unit}`));
    for (const [k, sample] of found.filter(([k]) => this.data.curves[k].label)) {
      const row = make("div", { class: `key ${this.data.curves[k].role}` });
      row.append(make("span", {}, this.data.curves[k].label), make("b", {}, `${rounded(sample[1])} ${yUnit}`));
      this.values.append(row);
    }
    this.values.hidden = false;
    const picture = this.svg.getBoundingClientRect();
    const scale = picture.width / this.svg.viewBox.baseVal.width;
    const wide = this.values.offsetWidth;
    const beside = across * scale + (across > (left + right) / 2 ? -wide - 12 : 12);
    const above = picture.top - this.figure.getBoundingClientRect().top;
    // On a phone, below the picture.
    const narrow = picture.width < 500;
    this.values.style.left = `${narrow ? 0 : Math.min(Math.max(beside, 0), picture.width - wide)}px`;
    this.values.style.top = `${above + (narrow ? picture.height + 2 : top * scale + 4)}px`;
  }

  leave() {
    this.marks.innerHTML = "";
    this.values.hidden = true;
  }
}
