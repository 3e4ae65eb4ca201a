// Plots: curves of uPlot with marks over them and points to drag, and files of their pictures and of their numbers.
"use strict";

/** @param {string} name */
const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** The labels of the units of quantities. @type {Record<string, string>} */
let units = {};

/** Words with the unit of a quantity. @param {Named} of */
const labelled = ([words, quantity]) => ((units[quantity] ?? "1") === "1" ? words : `${words} (${units[quantity]})`);

/** @param {string} text */
const escaped = (text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);

/** A label in HTML as plain text, such as F_s. @param {string} html */
const plain = (html) => html.replace(/<sub>/g, "_").replace(/<[^>]*>/g, "");

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** The width of a letter. */
const LETTER = 5.8;

/** The path of a circle. @param {number} x @param {number} y @param {number} radius */
function circle(x, y, radius) {
  const half = `a${radius} ${radius} 0 1 0`;
  return `M${(x - radius).toFixed(2)} ${y.toFixed(2)}${half} ${2 * radius} 0${half} ${-2 * radius} 0`;
}

/** The text of an SVG, in pixels of the page. Colours are names of the style. */
class Svg {
  constructor() {
    /** @type {string[]} */
    this.parts = [];
  }
  /** @param {string} d the path in the words of SVG @param {{stroke?: string, fill?: string, width?: number, dash?: number[]}} how */
  path(d, { stroke, fill, width = 1.5, dash = [] }) {
    const [outside, inside] = [stroke, fill].map((name) => (name ? color(name) : "none"));
    this.parts.push(`<path d="${d}" fill="${inside}" stroke="${outside}" stroke-width="${width}" stroke-dasharray="${dash.join(" ")}"/>`);
  }
  /** Letters become smaller where the words, which may be a label in HTML, do not fit into the room. @param {number} x @param {number} y @param {string} words @param {{anchor?: string, turn?: number, room?: number}} [how] */
  text(x, y, words, { anchor = "start", turn = 0, room = Infinity } = {}) {
    const size = Math.min(11, (11 * room) / (LETTER * plain(words).length));
    const symbols = escaped(words.replace(/<\/?sub>/g, (tag) => (tag === "<sub>" ? "_" : ""))).replace(/&#60;i&#62;(.*?)&#60;\/i&#62;/g, '<tspan font-style="italic">$1</tspan>');
    const inside = symbols.replace(/_(\w+)/g, '<tspan dy="3" font-size="8">$1</tspan><tspan dy="-3">\u200b</tspan>');
    this.parts.push(`<text transform="translate(${x} ${y}) rotate(${turn})" text-anchor="${anchor}" font-size="${size.toFixed(1)}" fill="${color("ink")}">${inside}</text>`);
  }
  /** @param {string} picture its address @param {[left: number, top: number, width: number, height: number]} box */
  picture(picture, [left, top, width, height]) {
    const place = `x="${left}" y="${top}" width="${width}" height="${height}" preserveAspectRatio="none"`;
    this.parts.push(`<image ${place} image-rendering="pixelated" href="${picture}"/>`);
  }
  /** Cuts what `draw` draws at a box. @param {string} id @param {Pen["box"]} box @param {() => void} draw */
  within(id, { left, top, width, height }, draw) {
    this.parts.push(`<clipPath id="${id}"><rect x="${left}" y="${top}" width="${width}" height="${height}"/></clipPath><g clip-path="url(#${id})">`);
    draw();
    this.parts.push("</g>");
  }
  /** @param {string} title @param {number} width @param {number} height */
  file(title, width, height) {
    const size = `width="${width}" height="${height}" viewBox="0 0 ${width} ${height}"`;
    const head = `<svg xmlns="http://www.w3.org/2000/svg" ${size} font-family="system-ui, sans-serif" font-size="11"><title>${escaped(title)}</title>`;
    return [head, `<rect width="${width}" height="${height}" fill="${color("paper")}"/>`, ...this.parts, "</svg>", ""].join("\n");
  }
}

/** Draws marks in the coordinates of a plot. */
class Pen {
  /** @param {uPlot} plot @param {Svg} svg */
  constructor(plot, svg) {
    this.plot = plot;
    this.svg = svg;
    const [left, top, width, height] = [plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height].map((length) => length / uPlot.pxRatio);
    this.box = { left, top, width, height, right: left + width, bottom: top + height };
  }
  /** @param {"x" | "y"} scale @param {number} value */
  place(scale, value) {
    return this.plot.valToPos(value, scale, true) / uPlot.pxRatio;
  }
  /** A path through points; it is interrupted by those without a place. @param {(readonly [number, number | null | undefined])[]} points */
  through(points) {
    let step = "M";
    const to = (/** @type {readonly [number, number | null | undefined]} */ [x, y]) => {
      const [left, top] = [this.place("x", x), this.place("y", y ?? NaN)];
      const there = Number.isFinite(left) && Number.isFinite(top);
      const part = there ? `${step}${left.toFixed(2)} ${top.toFixed(2)}` : "";
      step = there ? "L" : "M";
      return part;
    };
    return points.map(to).join("");
  }
  /** @param {(readonly [number, number | null | undefined])[]} points @param {string} stroke @param {{dash?: number[], width?: number}} [how] */
  line(points, stroke, how) {
    this.svg.path(this.through(points), { stroke, ...how });
  }
  /** @param {[number, number][]} points @param {string} fill */
  area(points, fill) {
    this.svg.path(`${this.through(points)}Z`, { fill });
  }
  /** @param {[number, number][]} points @param {string} stroke @param {{radius?: number, hollow?: boolean}} [how] */
  dots(points, stroke, { radius = 4, hollow = false } = {}) {
    const places = points.map(([x, y]) => [this.place("x", x), this.place("y", y)]).filter((place) => place.every(Number.isFinite));
    this.svg.path(places.map(([left, top]) => circle(left, top, radius)).join(""), { stroke, fill: hollow ? "paper" : stroke });
  }
  /** @param {number} x @param {number} y @param {string} words */
  text(x, y, words) {
    this.svg.text(this.place("x", x), this.place("y", y), words);
  }
}

/** Colours of a field from low to high, those of viridis. */
const FIELD = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

/** @param {number} share from 0 to 1 */
function fieldColor(share) {
  const place = Math.min(share * (FIELD.length - 1), FIELD.length - 1.001);
  const [low, high] = [FIELD[Math.floor(place)], FIELD[Math.floor(place) + 1]];
  return [...low.map((part, i) => part + (high[i] - part) * (place % 1)), 255];
}

/** A picture of so many pixels, each of the colour of a share. @param {number} width @param {number} height @param {(x: number, y: number) => number} share */
function pixels(width, height, share) {
  const picture = Object.assign(document.createElement("canvas"), { width, height });
  const context = picture.getContext("2d");
  const image = new ImageData(width, height);
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) image.data.set(fieldColor(share(x, y)), 4 * (y * width + x));
  context?.putImageData(image, 0, 0);
  return picture.toDataURL();
}

/** The number at a tick of an axis. @param {number} place */
function tick(place) {
  const size = Math.abs(place);
  return size > 0 && (size < 1e-3 || size >= 1e5) ? place.toExponential() : String(Number(place.toPrecision(6)));
}

class Chart {
  /** @param {string} id @param {Shape} shape */
  constructor(id, shape) {
    this.id = id;
    this.shape = shape;
    this.element = /** @type {HTMLElement} */ (document.getElementById(id));
    /** @type {uPlot.AlignedData} */
    this.data = [[], ...shape.lines.map(() => [])];
    /** The places of numbers on the axes, as they are drawn. @type {{x: number[], y: number[]}} */
    this.places = { x: [], y: [] };
    /** The picture of the last field. @type {{values: number[], picture: string} | null} */
    this.painted = null;
    this.marks = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    this.marks.setAttribute("class", "marks");
    /** @type {uPlot} */
    this.plot = this.make();
    this.addFiles();
    new ResizeObserver(() => this.plot.setSize(this.size())).observe(this.element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.reshape({}));
  }

  size() {
    return { width: Math.max(200, this.element.clientWidth), height: this.shape.field ? 280 : 215 };
  }

  /** @returns {uPlot} */
  make() {
    const { lines, logarithmic, field } = this.shape;
    const axis = (/** @type {"x" | "y"} */ key) => ({
      font: "11px system-ui, sans-serif",
      stroke: () => color("ink"), grid: { stroke: () => color("faint"), width: 0.5 }, ticks: { stroke: () => color("faint"), width: 0.5 },
      // Those between the numbers of a logarithmic axis are null.
      values: (/** @type {uPlot} */ _, /** @type {(number | null)[]} */ places) => {
        const known = places.filter((place) => place !== null);
        // Ten decades do not fit side by side.
        this.places[key] = known.filter((_, i) => !logarithmic?.[+(key === "y")] || i % Math.ceil(known.length / 7) === 0);
        return places.map((place) => (place !== null && this.places[key].includes(place) ? tick(place) : ""));
      },
    });
    /** A field reaches from edge to edge. @type {uPlot.Scale.Range} */
    const exact = (_, low, high) => [low, high];
    const scale = (/** @type {boolean | undefined} */ log) => ({ time: false, ...(field ? { range: exact } : log ? { distr: /** @type {3} */ (3) } : {}) });
    // The words at the axes are marks.
    const wide = (/** @type {uPlot} */ _, /** @type {string[] | null} */ numbers) => Math.max(66, 34 + LETTER * Math.max(0, ...(numbers ?? []).map((number) => number.length)));
    const plot = new uPlot({
      ...this.size(),
      scales: { x: scale(logarithmic?.[0]), y: scale(logarithmic?.[1]) },
      axes: [{ ...axis("x"), size: 52 }, { ...axis("y"), size: wide }],
      series: [{}, ...lines.map((line) => ({
        stroke: () => color(line.color), width: 1.75, dash: line.dash, points: { show: false }, spanGaps: false, ...(line.as ? { paths: () => null } : {}),
      })), ...(field ? [{ width: 0, points: { show: false } }] : [])],
      padding: [null, field ? 66 : null, null, null],
      cursor: { drag: { x: false, y: false }, points: { show: false } },
      legend: { show: false },
      hooks: { draw: [(/** @type {uPlot} */ plot) => this.drawMarks(plot)] },
    }, this.data, this.element);
    this.addDragging(plot);
    return plot;
  }

  /** Draws the marks over the plot. @param {uPlot} plot */
  drawMarks(plot) {
    const pen = new Pen(plot, new Svg());
    this.drawField(pen);
    pen.svg.within(`${this.id}-plot`, pen.box, () => this.shape.marks?.(pen));
    this.drawLines(pen, (line) => line.as !== undefined);
    pen.dots(this.handles(plot).map(({ x, y }) => [x, y]), "orange", { radius: 5, hollow: true });
    this.element.style.paddingBottom = `${this.drawWords(pen)}px`;
    this.marks.innerHTML = pen.svg.parts.join("");
    this.marks.setAttribute("viewBox", `0 0 ${plot.width} ${plot.height}`);
    plot.over.before(this.marks);
  }

  /** What can be dragged: at the edge where it is beyond it, from which it is dragged back. @param {uPlot} plot @returns {Handle[]} */
  handles({ scales }) {
    const within = (/** @type {number} */ value, /** @type {uPlot.Scale} */ { min, max }) => Math.min(Math.max(value, min ?? value), max ?? value);
    return (this.shape.handles?.() ?? []).map((handle) => ({ ...handle, x: within(handle.x, scales.x), y: within(handle.y, scales.y) }));
  }

  /** @param {Pen} pen @param {(line: Line) => boolean} which */
  drawLines(pen, which) {
    this.shape.lines.forEach((line, i) => {
      const points = Array.from(this.data[0], (x, j) => /** @type {[number, number]} */ ([x, this.data[i + 1][j]])).filter(([, y]) => y !== undefined);
      if (!which(line)) return;
      if (line.as) pen.dots(points, line.color, { hollow: line.as === "rings" });
      else pen.line(points, line.color, { dash: line.dash, width: 1.75 });
    });
  }

  /** Draws the words at the axes and the legend below. @param {Pen} pen @returns the height of the legend */
  drawWords({ svg, plot, box: { left, top, bottom, width, height } }) {
    const middle = top + height / 2;
    svg.text(left + width / 2, bottom + 40, labelled(this.shape.x), { anchor: "middle", room: plot.width });
    svg.text(12, middle, labelled(this.shape.y), { anchor: "middle", turn: -90, room: 2 * middle });
    const entries = [...this.shape.lines, ...(this.shape.keys?.() ?? [])];
    if (entries.length < 2) return 0;
    let [x, y] = [12, plot.height + 8];
    for (const { label, color, dash, as } of entries) {
      const space = 40 + LETTER * plain(label).length;
      if (x > 12 && x + space > plot.width) [x, y] = [12, y + 16];
      if (as === "band") svg.path(`M${x} ${y - 5}h20v10h-20Z`, { fill: color });
      else if (as) svg.path(circle(x + 10, y, 4), { stroke: color, fill: as === "rings" ? "paper" : color });
      else svg.path(`M${x} ${y}h20`, { stroke: color, dash, width: 1.75 });
      svg.text(x + 26, y + 4, label, { room: plot.width - x - 26 });
      x += space;
    }
    return y + 12 - plot.height;
  }

  /** Draws the field, each place by the last values before it, and the scale of its colours. @param {Pen} pen */
  drawField({ svg, box: { left, top, right, bottom, width, height } }) {
    const field = this.shape.field?.();
    if (!field) return;
    const { at, cells, values, of } = field;
    const [low, high] = values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
    const row = (/** @type {number} */ x) => Math.max(at.findIndex((place) => place > at[0] + ((at[at.length - 1] - at[0]) * (x + 0.5)) / 600), 1) - 1;
    if (this.painted?.values !== values) {
      const rows = Array.from({ length: 600 }, (_, x) => row(x));
      this.painted = { values, picture: pixels(600, cells, (x, y) => (values[rows[x] * cells + cells - 1 - y] - low) / (high - low || 1)) };
    }
    svg.picture(this.painted.picture, [left, top, width, height]);
    svg.picture(pixels(1, 64, (_, y) => 1 - y / 63), [right + 10, top, 10, height]);
    svg.text(right + 24, bottom, low.toPrecision(3));
    svg.text(right + 24, top + 8, high.toPrecision(3));
    svg.text(right + 34, top + height / 2, labelled(of), { anchor: "middle", turn: -90 });
  }

  /** @param {uPlot.AlignedData} data */
  set(data) {
    this.data = data;
    this.plot.setData(data);
  }

  /** Draws other variables. @param {Partial<Shape>} shape */
  reshape(shape) {
    Object.assign(this.shape, shape);
    this.plot.destroy();
    this.plot = this.make();
  }

  /** @param {uPlot} plot */
  addDragging(plot) {
    const nearest = (/** @type {MouseEvent} */ event) => {
      const far = (/** @type {Handle} */ { x, y }) => Math.hypot(plot.valToPos(x, "x") - event.offsetX, plot.valToPos(y, "y") - event.offsetY);
      return this.handles(plot).filter((handle) => far(handle) < 16).sort((a, b) => far(a) - far(b))[0];
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
      if (event.button !== 0) return;
      const handle = nearest(event);
      const { scrub } = this.shape;
      const [x, y] = [axis("x"), axis("y")];
      const across = (/** @type {PointerEvent} */ to) => x(to.offsetX / plot.over.clientWidth);
      if (handle) {
        // Where it was taken beside its middle, so that a click does not move it.
        const [left, top] = [plot.valToPos(handle.x, "x") - event.offsetX, plot.valToPos(handle.y, "y") - event.offsetY];
        moving = (to) => handle.move(x((to.offsetX + left) / plot.over.clientWidth), y(1 - (to.offsetY + top) / plot.over.clientHeight));
      } else if (scrub) {
        moving = (to) => scrub(across(to));
        moving(event);
      } else return;
      plot.over.setPointerCapture(event.pointerId);
    });
    plot.over.addEventListener("pointermove", (event) => {
      plot.over.style.cursor = nearest(event) ? "grab" : this.shape.scrub ? "ew-resize" : "default";
      moving?.(event);
    });
    for (const end of ["pointerup", "pointercancel"]) plot.over.addEventListener(end, () => (moving = null));
    plot.over.addEventListener("dblclick", (event) => {
      const handle = nearest(event);
      if (handle) handle.remove?.();
      else this.shape.add?.(axis("x")(event.offsetX / plot.over.clientWidth));
    });
  }

  /** The buttons that save the plot. */
  addFiles() {
    const box = Object.assign(document.createElement("div"), { className: "export" });
    const files = { SVG: { type: "image/svg+xml", text: () => this.svg() }, CSV: { type: "text/csv", text: () => this.csv() } };
    for (const [name, { type, text }] of Object.entries(files)) {
      const button = Object.assign(document.createElement("button"), { textContent: name });
      button.onclick = () => download(new Blob([text()], { type }), `${this.id}.${name.toLowerCase()}`);
      box.append(button);
    }
    this.element.append(box);
    this.title();
  }

  /** The title, which the names of the buttons have, too. @param {string} [words] another one */
  title(words) {
    const caption = /** @type {HTMLElement} */ (this.element.querySelector("figcaption"));
    if (words !== undefined) caption.textContent = words;
    const title = caption.textContent ?? "";
    for (const button of /** @type {NodeListOf<HTMLElement>} */ (this.element.querySelectorAll(".export button"))) button.ariaLabel = `${button.textContent} of ${title}`;
    return title;
  }

  /** The picture as it is: axes and lines, which uPlot draws on the screen, and marks. */
  svg() {
    const { plot, shape, places } = this;
    const svg = new Svg();
    const pen = new Pen(plot, svg);
    const { left, top, right, bottom } = pen.box;
    for (const x of places.x) {
      svg.path(`M${pen.place("x", x)} ${top}V${bottom}`, { stroke: "faint", width: 0.5 });
      svg.text(pen.place("x", x), bottom + 16, tick(x), { anchor: "middle" });
    }
    for (const y of places.y) {
      svg.path(`M${left} ${pen.place("y", y)}H${right}`, { stroke: "faint", width: 0.5 });
      svg.text(left - 6, pen.place("y", y) + 4, tick(y), { anchor: "end" });
    }
    this.drawField(pen);
    svg.within("plot", pen.box, () => {
      this.drawLines(pen, (line) => !line.as);
      shape.marks?.(pen);
    });
    this.drawLines(pen, (line) => line.as !== undefined);
    const legend = this.drawWords(pen);
    return svg.file(this.title(), plot.width, plot.height + legend + 4);
  }

  /** The numbers in all their digits: the lines, then what else is drawn. */
  csv() {
    const { x, y, lines, more, field } = this.shape;
    /** @type {[string, ArrayLike<number | null | undefined>][]} */
    const columns = field ? [] : [[labelled(x), this.data[0]], ...lines.map((line, i) => /** @type {[string, any]} */ ([labelled([plain(line.label), y[1]]), this.data[i + 1]]))];
    columns.push(...(more?.() ?? []).map(([name, values]) => /** @type {[string, number[]]} */ ([labelled(name), values])));
    const rows = Math.max(...columns.map((column) => column[1].length));
    const head = columns.map(([name]) => `"${name.replace(/"/g, '""')}"`).join(",");
    return [head, ...Array.from({ length: rows }, (_, i) => columns.map((column) => column[1][i] ?? "").join(",")), ""].join("\n");
  }
}
