// Pictures as the engine draws them: points to drag in them, and files of the pictures and of their numbers.
"use strict";

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** @param {Axis} axis @param {number} share from 0 to 1 */
const valueAt = ({ min, max, logarithmic }, share) => (logarithmic ? min * (max / min) ** share : min + (max - min) * share);

/** A picture in the page. */
class Figure {
  /** @param {HTMLElement} element */
  constructor(element) {
    this.element = element;
    this.picture = /** @type {HTMLElement} */ (element.querySelector(".picture"));
    /** What is shown. @type {Panel | null} */
    this.panel = null;
    this.drawn = "";
    this.beside = /** @type {HTMLElement} */ (element.querySelector(".export"));
    const [svg, csv] = (this.buttons = this.beside.querySelectorAll("button"));
    svg.onclick = () => download(new Blob([this.file()], { type: "image/svg+xml" }), `${element.id}.svg`);
    csv.onclick = () => download(new Blob([this.csv()], { type: "text/csv" }), `${element.id}.csv`);
    this.addDragging();
  }

  /** @param {Panel | null} panel */
  show(panel) {
    this.panel = panel;
    this.element.hidden = !panel;
    const drawn = panel ? this.svg() : "";
    if (!panel || drawn === this.drawn) return;
    this.drawn = this.picture.innerHTML = drawn;
    this.beside.dataset.values = "";
    const caption = Object.assign(/** @type {HTMLElement} */ (this.element.querySelector("figcaption")), { innerHTML: panel.title });
    for (const button of this.buttons) button.ariaLabel = `${button.textContent} of ${caption.textContent}`;
  }

  /** The picture with a dot for each reading. @param {string} [title] of a file */
  svg(title = "") {
    if (!this.panel) return "";
    const [width, height] = this.panel.size;
    const dots = state.measured?.position.map((x, i) => `M${x} ${state.measured?.force[i]}h0`).join("");
    const size = `width="${width}" height="${height}" viewBox="0 0 ${width} ${height}"`;
    const inside = this.panel.svg.replace('class="readings" d=""', `d="${dots}"`);
    return `<svg xmlns="http://www.w3.org/2000/svg" ${size} font-family="system-ui, sans-serif" font-size="11">${title}${inside}</svg>`;
  }

  /** The picture as a file, with the colours of the page and without what is dragged. */
  file() {
    const style = getComputedStyle(document.documentElement);
    const title = `<title>${this.element.querySelector("figcaption")?.textContent}</title><rect width="100%" height="100%" fill="var(--paper)"/>`;
    const picture = this.svg(title).replace(/<g class="handles">.*?<\/g>/s, "");
    return picture.replace(/var\((--\w+)\)/g, (_, name) => style.getPropertyValue(name).trim());
  }

  /** The numbers in all their digits. */
  csv() {
    const columns = (this.panel?.columns ?? []).map(({ of, values, ...column }) => ({ ...column, values: of ? found(of) : values }));
    if (this.panel?.svg.includes('class="readings"') && state.measured) {
      const measured = { "measured X": state.measured.position, "measured F": state.measured.force };
      for (const [name, values] of Object.entries(measured)) columns.push({ name, values, times: 1, rows: values.length });
    }
    const head = columns.map(({ name }) => `"${name.replace(/"/g, '""')}"`).join(",");
    const cell = (/** @type {number} */ i) => (/** @type {typeof columns[number]} */ { values, times, rows }) =>
      i < rows ? values[Math.floor(i / times) % values.length] ?? "" : "";
    const lines = Array.from({ length: Math.max(...columns.map(({ rows }) => rows)) }, (_, i) => columns.map(cell(i)).join(","));
    return [head, ...lines, ""].join("\n");
  }

  /** Where the pointer is in the picture. @param {MouseEvent} event @returns {Pixel} */
  place({ clientX, clientY }) {
    const { left, top, width } = /** @type {Element} */ (this.picture.firstElementChild).getBoundingClientRect();
    const scale = (this.panel?.size[0] ?? 1) / width;
    return [(clientX - left) * scale, (clientY - top) * scale];
  }

  /** The values at a place of a panel: axes change with what is dragged, and would carry it on. @param {Panel} panel @param {Pixel} at */
  values({ plot: [left, top, width, height], x, y }, at) {
    const exact = [valueAt(x, (at[0] - left) / width), valueAt(y, 1 - (at[1] - top) / height)];
    return exact.map((value) => rounded(value, 5));
  }

  /** What is dragged at a place. @param {Pixel} place @returns {Handle | undefined} */
  nearest([x, y]) {
    const far = (/** @type {Handle} */ { at }) => Math.hypot(at[0] - x, at[1] - y);
    return this.panel?.handles.filter((handle) => far(handle) < 16).sort((a, b) => far(a) - far(b))[0];
  }

  /** @param {Pixel} place */
  within([x, y]) {
    const [left, top, width, height] = this.panel?.plot ?? [0, 0, 0, 0];
    return x >= left && x <= left + width && y >= top && y <= top + height;
  }

  /** What moves with the pointer that goes down at a place. @param {Pixel} place @returns {((to: Pixel) => void) | null} */
  taken(place) {
    const [panel, handle] = [this.panel, this.nearest(place)];
    if (!panel) return null;
    if (handle) {
      // Where it was taken beside its middle, so that a click does not move it.
      const [left, top] = [handle.at[0] - place[0], handle.at[1] - place[1]];
      return ([x, y]) => put(handle.change, ...this.values(panel, [x + left, y + top]).map(toml));
    }
    if (!panel.scrub || !this.within(place)) return null;
    const moved = (/** @type {Pixel} */ to) => scrub(this.values(panel, to)[0]);
    moved(place);
    return moved;
  }

  addDragging() {
    const { picture } = this;
    /** @type {((to: Pixel) => void) | null} */
    let moving = null;
    picture.onpointerdown = (event) => {
      if (event.button === 0) moving = this.taken(this.place(event));
      if (moving) picture.setPointerCapture(event.pointerId);
    };
    picture.onpointermove = (event) => {
      const place = this.place(event);
      const [x, y] = this.panel && this.within(place) ? this.values(this.panel, place) : [];
      this.beside.dataset.values = x === undefined ? "" : `x = ${x}, y = ${y}`;
      picture.style.cursor = this.nearest(place) ? "grab" : this.panel?.scrub && this.within(place) ? "ew-resize" : "default";
      moving?.(place);
    };
    picture.onpointerleave = () => (this.beside.dataset.values = "");
    picture.onpointerup = picture.onpointercancel = () => (moving = null);
    picture.ondblclick = (event) => {
      const place = this.place(event);
      const handle = this.nearest(place);
      if (handle?.remove) put(handle.remove);
      else if (!handle && this.panel?.add && this.within(place)) put(this.panel.add, toml(this.values(this.panel, place)[0]));
    };
  }
}
