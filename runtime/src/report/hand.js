// The hands of a reader on a picture: buttons, names of curves, pointer, keys.

// The choice of a variable, and buttons.
function tools(picture) {
  const all = make("span", { class: "tools" });
  if (picture.data.views.length > 1) {
    const choice = make("select", { "aria-label": "over which variable" });
    for (const view of picture.data.views) choice.append(make("option", {}, `over ${named(view.x)[0]}`));
    choice.addEventListener("change", () => picture.show(picture.data.views[choice.selectedIndex]));
    all.append(choice);
  }
  const button = (text, title, act) => {
    const made = make("button", { type: "button", title, "aria-label": title }, text);
    made.addEventListener("click", act);
    all.append(made);
  };
  button("\u2212", "zoom out", () => picture.zoom(STEP));
  button("+", "zoom in", () => picture.zoom(1 / STEP));
  button("\u25c2", "back", () => picture.pan(-0.25));
  button("\u25b8", "on", () => picture.pan(0.25));
  button("\u21ba", "show all", () => picture.reset());
  picture.figure.querySelector("figcaption").append(all);
}

// A press on a name takes its curve away and brings it back; a curve without a name goes with the one before.
function legend(picture) {
  let owner = -1;
  const owners = picture.data.curves.map((curve, k) => (curve.label ? (owner = k) : owner));
  const keys = [...picture.figure.querySelectorAll(".legend .key")];
  picture.data.curves.filter((curve) => curve.label).forEach((curve, place) => {
    if (!keys[place]) return;
    const key = make("button", { type: "button", class: keys[place].className, "aria-pressed": "true" }, curve.label);
    key.addEventListener("click", () => {
      const shown = key.getAttribute("aria-pressed") === "false";
      key.setAttribute("aria-pressed", String(shown));
      owners.forEach((of, k) => {
        if (picture.data.curves[of] === curve) picture.hidden[shown ? "delete" : "add"](k);
      });
      picture.fit();
      picture.draw();
    });
    keys[place].replaceWith(key);
  });
}

function pointer(picture) {
  const { svg } = picture;
  const place = (event) => {
    const drawn = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / drawn.width;
    return [(event.clientX - drawn.left) * scale, (event.clientY - drawn.top) * scale];
  };
  let drag = null;
  svg.setAttribute("tabindex", "0");
  svg.setAttribute("role", "application");
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    // A finger moves what is zoomed and reads what is not.
    const touch = event.pointerType !== "mouse";
    const zoomed = !same(picture.range.slice(0, 2), picture.view.range);
    drag = { from: place(event), range: [...picture.range], moves: event.shiftKey || (touch && zoomed), reads: touch && !zoomed };
    svg.setPointerCapture(event.pointerId);
    if (touch) picture.read(drag.from);
  });
  svg.addEventListener("pointermove", (event) => {
    const to = place(event);
    if (!drag || drag.reads) return picture.read(to);
    const [left, top, right, floor] = picture.frame;
    if (drag.moves) return picture.pan((drag.from[0] - to[0]) / (right - left), drag.range);
    picture.leave();
    const between = (a, b, low, high) => [a, b].map((v) => Math.min(Math.max(v, low), high)).sort((a, b) => a - b);
    const [x0, x1] = between(drag.from[0], to[0], left, right);
    let [y0, y1] = between(drag.from[1], to[1], top, floor);
    const flat = y1 - y0 < 30; // a box of all y
    if (flat) [y0, y1] = [top, floor];
    drag.box = { x0, x1, y0, y1, flat };
    picture.marks.innerHTML = `<rect class="box" x="${x0}" y="${y0}" width="${x1 - x0}" height="${y1 - y0}"/>`;
  });
  svg.addEventListener("pointerup", () => {
    const box = drag?.box;
    drag = null;
    if (!box || box.x1 - box.x0 < 8) return picture.leave();
    const [low, high] = [picture.at([box.x0, box.y1]), picture.at([box.x1, box.y0])];
    picture.setX(low[0], high[0], box.flat ? null : [low[1], high[1]]);
  });
  svg.addEventListener("pointercancel", () => { drag = null; picture.leave(); });
  svg.addEventListener("pointerleave", () => { if (!drag) picture.leave(); });
  svg.addEventListener("dblclick", () => picture.reset());
  svg.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
    event.preventDefault();
    picture.zoom(event.deltaY > 0 ? STEP : 1 / STEP, picture.at(place(event))[0]);
  }, { passive: false });
  svg.addEventListener("keydown", (event) => key(picture, event));
  svg.addEventListener("blur", () => picture.leave());
}

function key(picture, event) {
  const side = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  const [left, top, right] = picture.frame;
  if (side && event.shiftKey) picture.pan(0.25 * side);
  else if (side) picture.read([(picture.reading?.[0] ?? (left + right) / 2) + 6 * side, picture.reading?.[1] ?? top]);
  else if (event.key === "+" || event.key === "=") picture.zoom(1 / STEP);
  else if (event.key === "-") picture.zoom(STEP);
  else if (event.key === "0" || event.key === "Escape") picture.reset();
  else return;
  event.preventDefault();
}

document.querySelectorAll("figure").forEach((figure, number) => {
  if (!figure.querySelector("svg") || !figure.querySelector("script")) return;
  const picture = new Picture(figure, number);
  for (const give of [tools, legend, pointer]) give(picture);
  pictures.push(picture);
});
const hint = "Drag over a picture to zoom, with shift to move; ctrl and wheel zoom at the pointer, a double click shows all. "
  + "Time axes go together. A press on a name takes its curve away. Keys: \u2190 \u2192 read, with shift they move, + \u2212 0 zoom.";
pictures[0]?.figure.before(make("p", { class: "note hint" }, hint));
