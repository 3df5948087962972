// Pictures that a reader explores: zoom and pan, values under the pointer, curves on and off, another variable.
// It works on the SVG of the page and on the samples beside it; without it the page is whole.
"use strict";
(() => {
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
      this.tools();
      this.legend();
      this.pointer();
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

    tools() {
      const tools = make("span", { class: "tools" });
      if (this.data.views.length > 1) {
        const choice = make("select", { "aria-label": "over which variable" });
        for (const view of this.data.views) choice.append(make("option", {}, `over ${named(view.x)[0]}`));
        choice.addEventListener("change", () => this.show(this.data.views[choice.selectedIndex]));
        tools.append(choice);
      }
      const button = (text, title, act) => {
        const made = make("button", { type: "button", title, "aria-label": title }, text);
        made.addEventListener("click", act);
        tools.append(made);
      };
      button("\u2212", "zoom out", () => this.zoom(STEP));
      button("+", "zoom in", () => this.zoom(1 / STEP));
      button("\u25c2", "earlier or smaller", () => this.pan(-0.25));
      button("\u25b8", "later or larger", () => this.pan(0.25));
      button("\u21ba", "show all", () => this.reset());
      this.figure.querySelector("figcaption").append(tools);
    }

    // A press on a name takes its curve away and brings it back; a curve without a name goes with the one before.
    legend() {
      let owner = -1;
      const owners = this.data.curves.map((curve, k) => (curve.label ? (owner = k) : owner));
      const keys = [...this.figure.querySelectorAll(".legend .key")];
      this.data.curves.filter((curve) => curve.label).forEach((curve, place) => {
        if (!keys[place]) return;
        const key = make("button", { type: "button", class: keys[place].className, "aria-pressed": "true" }, curve.label);
        key.addEventListener("click", () => {
          const shown = key.getAttribute("aria-pressed") === "false";
          key.setAttribute("aria-pressed", String(shown));
          owners.forEach((of, k) => {
            if (this.data.curves[of] === curve) this.hidden[shown ? "delete" : "add"](k);
          });
          this.fit();
          this.draw();
        });
        keys[place].replaceWith(key);
      });
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

    // Shows an interval of x, and with a time axis in every picture with a time axis that has something there.
    setX(low, high, y) {
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
      const interval = pictures.find((p) => p !== this && view.time && p.view.time && !same(p.range.slice(0, 2), p.view.range));
      if (interval) this.setX(interval.range[0], interval.range[1]);
      this.fit();
      this.draw();
    }

    path(k) {
      const [x, y] = this.xy(k);
      const [x0, x1] = this.range;
      const kind = this.data.curves[k].kind;
      const ground = this.px([0, 0])[1].toFixed(1);
      const inside = (i) => i >= 0 && i < x.length && x[i] >= x0 && x[i] <= x1;
      let [path, pen] = ["", false];
      for (let i = 0; i < x.length; i++) {
        const near = inside(i) || (kind === "line" && (inside(i - 1) || inside(i + 1) || (x[i] < x0 && x[i + 1] > x1) || (x[i] > x1 && x[i - 1] < x0)));
        const draws = near && y[i] === y[i];
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
      this.svg.querySelector(".ticks.x").innerHTML = ticks([x0, x1], 7).map(([value, label]) => {
        const at = this.px([value, 0])[0].toFixed(1);
        return `<path class="grid" d="M${at} ${top}V${floor}"/><text x="${at}" y="${floor + 17}" text-anchor="middle">${label}</text>`;
      }).join("");
      this.svg.querySelector(".ticks.y").innerHTML = ticks([y0, y1], 5).map(([value, label]) => {
        const at = this.px([0, value])[1];
        return `<path class="grid" d="M${left} ${at.toFixed(1)}H${right}"/><text x="${left - 6}" y="${(at + 4).toFixed(1)}" text-anchor="end">${label}</text>`;
      }).join("");
      this.svg.querySelector(".name.x").textContent = this.view.x;
      this.svg.querySelector(".bands").innerHTML = this.view !== this.data.views[0] ? "" : this.data.bands.map((band) => {
        const [from, to] = band.map((edge) => Math.min(Math.max(this.px([edge, 0])[0], left), right));
        return to > left && from < right ? `<rect class="band" x="${from}" y="${top}" width="${Math.max(to - from, 1)}" height="${floor - top}"/>` : "";
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
      this.values.style.left = `${Math.min(Math.max(beside, 0), picture.width - wide)}px`;
      this.values.style.top = `${this.svg.offsetTop + top * scale + 4}px`;
    }

    leave() {
      this.marks.innerHTML = "";
      this.values.hidden = true;
    }

    pointer() {
      const { svg } = this;
      const place = (event) => {
        const picture = svg.getBoundingClientRect();
        const scale = svg.viewBox.baseVal.width / picture.width;
        return [(event.clientX - picture.left) * scale, (event.clientY - picture.top) * scale];
      };
      let drag = null;
      svg.setAttribute("tabindex", "0");
      svg.setAttribute("role", "application");
      svg.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        // A finger moves what is zoomed and reads what is not.
        const touch = event.pointerType !== "mouse";
        const zoomed = !same(this.range.slice(0, 2), this.view.range);
        drag = { from: place(event), range: [...this.range], moves: event.shiftKey || (touch && zoomed), reads: touch && !zoomed };
        svg.setPointerCapture(event.pointerId);
        if (touch) this.read(drag.from);
      });
      svg.addEventListener("pointermove", (event) => {
        const to = place(event);
        if (!drag || drag.reads) return this.read(to);
        const [left, top, right, floor] = this.frame;
        if (drag.moves) return this.pan((drag.from[0] - to[0]) / (right - left), drag.range);
        this.leave();
        const [x0, x1] = [drag.from[0], to[0]].map((v) => Math.min(Math.max(v, left), right)).sort((a, b) => a - b);
        const [y0, y1] = [drag.from[1], to[1]].map((v) => Math.min(Math.max(v, top), floor)).sort((a, b) => a - b);
        const tall = y1 - y0 > 30; // else the box is of all y
        drag.box = [x0, tall ? y0 : top, x1, tall ? y1 : floor, tall];
        this.marks.innerHTML = `<rect class="box" x="${x0}" y="${drag.box[1]}" width="${x1 - x0}" height="${drag.box[3] - drag.box[1]}"/>`;
      });
      svg.addEventListener("pointerup", () => {
        const box = drag?.box;
        drag = null;
        if (!box || box[2] - box[0] < 8) return;
        const [low, high] = [this.at([box[0], box[3]]), this.at([box[2], box[1]])];
        this.setX(low[0], high[0], box[4] ? [low[1], high[1]] : null);
      });
      svg.addEventListener("pointercancel", () => { drag = null; this.leave(); });
      svg.addEventListener("pointerleave", () => { if (!drag) this.leave(); });
      svg.addEventListener("dblclick", () => this.reset());
      svg.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
        event.preventDefault();
        this.zoom(event.deltaY > 0 ? STEP : 1 / STEP, this.at(place(event))[0]);
      }, { passive: false });
      svg.addEventListener("keydown", (event) => this.key(event));
      svg.addEventListener("blur", () => this.leave());
    }

    key(event) {
      const side = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      const [left, top, right] = this.frame;
      if (side && event.shiftKey) this.pan(0.25 * side);
      else if (side) this.read([(this.reading?.[0] ?? (left + right) / 2) + 6 * side, this.reading?.[1] ?? top]);
      else if (event.key === "+" || event.key === "=") this.zoom(1 / STEP);
      else if (event.key === "-") this.zoom(STEP);
      else if (event.key === "0" || event.key === "Escape") this.reset();
      else return;
      event.preventDefault();
    }
  }

  document.querySelectorAll("figure").forEach((figure, number) => {
    if (figure.querySelector("svg") && figure.querySelector("script")) pictures.push(new Picture(figure, number));
  });
  const hint = "Pictures: drag to zoom, shift and drag to move, ctrl and wheel to zoom at the pointer, double click to show all; "
    + "time axes go together. A press on a name takes its curve away. Keys: + \u2212 \u2190 \u2192 0, with shift \u2190 \u2192 move.";
  pictures[0]?.figure.before(make("p", { class: "note hint" }, hint));
})();
