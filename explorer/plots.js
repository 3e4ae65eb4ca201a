// Plots: a curve chart of uPlot with marks drawn over it, points to drag, and files of its picture and its numbers.
"use strict";

/** @param {string} name */
const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** A label with italics and subscripts. @param {string} html */
function formatted(html) {
  const made = document.createElement("span");
  made.innerHTML = html;
  return made;
}

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Draws marks in the coordinates of a plot. */
class Pen {
  /** @param {uPlot} plot */
  constructor(plot) {
    this.plot = plot;
    this.context = plot.ctx;
    this.scale = devicePixelRatio;
  }
  /** @param {number} x @param {number} y @returns {[number, number]} */
  at(x, y) {
    return [this.plot.valToPos(x, "x", true), this.plot.valToPos(y, "y", true)];
  }
  /** @param {[number, number][]} points @param {string} name @param {{dash?: number[], width?: number}} [how] */
  line(points, name, { dash = [], width = 1.5 } = {}) {
    const { context } = this;
    context.beginPath();
    points.forEach(([x, y]) => context.lineTo(...this.at(x, y)));
    context.strokeStyle = color(name);
    context.lineWidth = width * this.scale;
    context.setLineDash(dash.map((length) => length * this.scale));
    context.stroke();
    context.setLineDash([]);
  }
  /** @param {[number, number][]} points @param {string} name */
  area(points, name) {
    const { context } = this;
    context.beginPath();
    points.forEach(([x, y]) => context.lineTo(...this.at(x, y)));
    context.fillStyle = color(name);
    context.fill();
  }
  /** @param {number} x @param {number} y @param {string} name @param {{radius?: number, hollow?: boolean}} [how] */
  dot(x, y, name, { radius = 4, hollow = false } = {}) {
    const { context } = this;
    context.beginPath();
    context.arc(...this.at(x, y), radius * this.scale, 0, 2 * Math.PI);
    context.lineWidth = 1.5 * this.scale;
    context.strokeStyle = color(name);
    context.fillStyle = color(hollow ? "paper" : name);
    context.fill();
    context.stroke();
  }
  /** @param {number} x @param {number} y @param {string} text @param {CanvasTextAlign} [align] */
  text(x, y, text, align = "left") {
    const { context } = this;
    const [left, top] = this.at(x, y);
    context.fillStyle = color("quiet");
    context.font = `${12 * this.scale}px system-ui, sans-serif`;
    context.textAlign = align;
    context.fillText(text, left, top);
  }
}

/** The numbers at the ticks of an axis; those between the labels of a logarithmic one are null. @param {(number | null)[]} places */
const ticks = (places) =>
  places.map((place) => {
    if (place === null) return "";
    const size = Math.abs(place);
    return size > 0 && (size < 1e-3 || size >= 1e5) ? place.toExponential() : String(Number(place.toPrecision(6)));
  });

class Chart {
  /** @param {string} id @param {Shape} shape */
  constructor(id, shape) {
    this.id = id;
    this.shape = shape;
    this.element = /** @type {HTMLElement} */ (document.getElementById(id));
    /** @type {uPlot.AlignedData} */
    this.data = [[], ...shape.lines.map(() => [])];
    /** @type {uPlot} */
    this.plot = this.make();
    this.addExports();
    new ResizeObserver(() => this.plot.setSize(this.size())).observe(this.element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.plot.destroy();
      this.plot = this.make();
    });
  }

  size() {
    return { width: Math.max(200, this.element.clientWidth), height: 215 };
  }

  /** @returns {uPlot} */
  make() {
    const { x, y, lines, logarithmic, marks } = this.shape;
    const axis = (/** @type {string} */ label) => ({
      label, values: (/** @type {uPlot} */ _, /** @type {(number | null)[]} */ places) => ticks(places), labelSize: 18, labelFont: "12px system-ui, sans-serif", font: "11px system-ui, sans-serif", size: 34,
      stroke: () => color("ink"), grid: { stroke: () => color("faint"), width: 0.5 }, ticks: { stroke: () => color("faint"), width: 0.5 },
    });
    const scale = (/** @type {boolean | undefined} */ log) => ({ time: false, ...(log ? { distr: /** @type {3} */ (3) } : {}) });
    const drawn = marks ? [(/** @type {uPlot} */ plot) => this.clipped(plot, marks)] : [];
    const plot = new uPlot({
      ...this.size(),
      scales: { x: scale(logarithmic?.[0]), y: scale(logarithmic?.[1]) },
      axes: [axis(x), { ...axis(y), size: 48 }],
      series: [{}, ...lines.map((line) => ({
        label: /** @type {any} */ (formatted(line.label)), stroke: () => color(line.color), width: 1.75, dash: line.dash, points: { show: false }, spanGaps: false,
      }))],
      cursor: { drag: { x: false, y: false }, points: { show: false } },
      legend: { show: lines.length > 1, live: false },
      hooks: { draw: drawn },
    }, this.data, this.element);
    this.addDragging(plot);
    return plot;
  }

  /** @param {uPlot} plot @param {(plot: uPlot, pen: Pen) => void} marks */
  clipped(plot, marks) {
    const { left, top, width, height } = plot.bbox;
    plot.ctx.save();
    plot.ctx.beginPath();
    plot.ctx.rect(left, top, width, height);
    plot.ctx.clip();
    marks(plot, new Pen(plot));
    for (const { x, y } of this.shape.handles?.() ?? []) new Pen(plot).dot(x, y, "orange", { radius: 5, hollow: true });
    plot.ctx.restore();
  }

  /** @param {uPlot.AlignedData} data */
  set(data) {
    this.data = data;
    this.plot.setData(data);
  }

  /** Draws other variables. @param {Shape} shape */
  reshape(shape) {
    if (shape.x === this.shape.x && shape.y === this.shape.y) return;
    Object.assign(this.shape, shape);
    this.data = [[], ...shape.lines.map(() => [])];
    this.plot.destroy();
    this.plot = this.make();
  }

  redraw() {
    this.plot.redraw(false);
  }

  /** @param {uPlot} plot */
  addDragging(plot) {
    const nearest = (/** @type {PointerEvent} */ event) => {
      const far = (/** @type {Handle} */ { x, y }) => Math.hypot(plot.valToPos(x, "x") - event.offsetX, plot.valToPos(y, "y") - event.offsetY);
      const handles = this.shape.handles?.() ?? [];
      return handles.filter((handle) => far(handle) < 16).sort((a, b) => far(a) - far(b))[0];
    };
    /** The value at a share of an axis as it is now: the axes change with what is dragged, and would carry it on. */
    const axis = (/** @type {"x" | "y"} */ key) => {
      const { min, max, distr } = plot.scales[key];
      const [low, high] = [min ?? 0, max ?? 1];
      return (/** @type {number} */ share) => (distr === 3 ? low * (high / low) ** share : low + (high - low) * share);
    };
    /** @type {((event: PointerEvent) => void) | null} */
    let moving = null;
    plot.over.addEventListener("pointerdown", (event) => {
      const handle = nearest(event);
      const { scrub } = this.shape;
      const [x, y] = [axis("x"), axis("y")];
      const across = (/** @type {PointerEvent} */ to) => x(to.offsetX / plot.over.clientWidth);
      if (handle) moving = (to) => handle.move(across(to), y(1 - to.offsetY / plot.over.clientHeight));
      else if (scrub) moving = (to) => scrub(across(to));
      else return;
      plot.over.setPointerCapture(event.pointerId);
      moving(event);
    });
    plot.over.addEventListener("pointermove", (event) => {
      plot.over.style.cursor = nearest(event) ? "grab" : this.shape.scrub ? "ew-resize" : "default";
      moving?.(event);
    });
    plot.over.addEventListener("pointerup", () => (moving = null));
  }

  addExports() {
    const box = document.createElement("div");
    box.className = "export";
    const button = (/** @type {string} */ label, /** @type {() => void} */ action) => {
      const made = document.createElement("button");
      made.textContent = label;
      made.setAttribute("aria-label", `${label} of ${this.element.querySelector("figcaption")?.textContent}`);
      made.onclick = action;
      box.append(made);
    };
    button("PNG", () => this.plot.ctx.canvas.toBlob((blob) => blob && download(blob, `${this.id}.png`)));
    button("CSV", () => download(new Blob([this.csv()], { type: "text/csv" }), `${this.id}.csv`));
    this.element.append(box);
  }

  csv() {
    const names = [this.shape.x, ...this.shape.lines.map((line) => formatted(line.label).textContent)];
    const rows = Array.from(this.data[0], (_, i) => this.data.map((/** @type {ArrayLike<number | null | undefined>} */ column) => column[i] ?? "").join(","));
    return [names.map((name) => `"${name}"`).join(","), ...rows, ""].join("\n");
  }
}
