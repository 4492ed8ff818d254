// What a page gains where scripts run: readouts, zoom with linked axes, series that can be hidden, points grouped and
// filtered by tags, tables that sort and filter, runs found by typing. Every page is complete without it.
//
// Numbers are read back from the drawn shapes: a panel is <g data-f="left top right bottom">, an axis in it <g class="axes"
// data-x="scale low high"> or data-y, a series <g data-s="name" data-r="runs">. Scales: 0 linear, 1 logarithm, 2 seconds since 1970 UTC,
// 3 names, 4 time about a step (with its unit and the positions per second before it). Runs are indices in runs.js and its further parts, which are loaded when they are first needed.
"use strict";
(() => {
  const root = document.documentElement.dataset.root || "";
  const SVG = "http://www.w3.org/2000/svg";
  const make = (name, attributes = {}, ...children) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  };
  const draw = (name, attributes, into) => {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    into.append(element);
    return element;
  };

  // One voice for readouts and counts.
  const voice = make("p", { role: "status", "aria-live": "polite", class: "unseen" });
  document.body.append(voice);
  let saying;
  const say = (text) => { clearTimeout(saying); saying = setTimeout(() => { voice.textContent = text; }, 250); };

  // ---------------------------------------------------------------- numbers
  const SUPER = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const raised = (n) => String(n).replace("-", "⁻").replace(/\d/g, (d) => SUPER[d]);
  const minus = (text) => text.replace("-", "−");
  const fixed = (value, decimals) => minus((Math.abs(value) < 0.5 * 10 ** -decimals ? 0 : value).toFixed(decimals));
  // As many digits as `step`, the size of a tenth of a pixel, allows.
  const shown = (value, step) => {
    if (!isFinite(value)) return "–";
    const size = Math.max(Math.abs(value), step);
    const digits = Math.min(5, Math.max(2, Math.ceil(Math.log10(size / step)) + 1));
    const power = value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value)));
    if (power >= 5 || power < -2) return fixed(value / 10 ** power, digits - 1) + "·10" + raised(power);
    return fixed(value, Math.max(0, Math.min(6, digits - 1 - power)));
  };
  // A moment by the clock that the axis names; a zone that the browser does not know is shown in UTC.
  const moment = (seconds, zone = "UTC") => {
    const date = new Date(1000 * seconds);
    if (zone !== "UTC") try { return date.toLocaleString("sv-SE", { timeZone: zone }).slice(0, 16); } catch { /* as below */ }
    return date.toISOString().slice(0, 16).replace("T", " ");
  };
  const zoneIn = (title) => /\(([^()]+)\)/.exec(title || "")?.[1] || "UTC";
  // First number of a cell: `< 4·10⁻⁵`, `24.6 ± 0.3`, `20 Nov 2026, 15:08 UTC`.
  const numberIn = (text) => {
    const date = /^\d{1,2} [A-Z][a-z]{2} \d{4}/.test(text) && Date.parse(text.replace(",", "").replace(/([+-]\d\d):(\d\d)$/, "$1$2"));
    if (date) return date;
    const found = /[−-]?\d+(?:\.\d+)?/.exec(text);
    if (!found) return NaN;
    const power = /·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/.exec(text);
    const exponent = power ? Number([...power[1]].map((c) => (c === "⁻" ? "-" : SUPER.indexOf(c))).join("")) : 0;
    return Number(found[0].replace("−", "-")) * 10 ** exponent;
  };

  // ---------------------------------------------------------------- runs
  const loading = new Map();
  const load = (file) => {
    if (!loading.has(file)) loading.set(file, new Promise((resolve) => {
      const script = make("script", { src: root + file });
      script.onload = resolve;
      script.onerror = resolve;
      document.head.append(script);
    }));
    return loading.get(file);
  };
  const known = [], readParts = new Set();
  // Runs at their indices: all, or only the parts of the index that hold those wanted.
  const runs = async (wanted) => {
    await load("runs.js");
    const index = window.ieapRuns || { keys: [], values: [], pages: [], files: [], each: 1, runs: [] };
    const parts = wanted ? new Set([...wanted].map((run) => Math.floor(run / index.each))) : new Set(index.files.keys());
    await Promise.all([...parts].map((part) => index.files[part] && load(index.files[part])));
    for (const part of parts) {
      if (readParts.has(part) || !index.runs[part]) continue;
      readParts.add(part);
      index.runs[part].forEach(([name, place, page, ...tags], k) => {
        const run = { name, place, href: root + "runs/" + index.pages[page] + ".html" + (place && "#" + place), tags: {} };
        tags.forEach((at, k) => { if (at >= 0) run.tags[index.keys[k]] = index.values[k][at]; });
        run.text = (name + " " + Object.entries(run.tags).map(([key, value]) => key + "=" + value).join(" ")).toLowerCase();
        known[part * index.each + k] = run;
      });
    }
    return known;
  };
  // Whether a run answers every word: `air`, `voltage_v=2.5`, `relative_humidity_percent>60`.
  const matcher = (query) => {
    const words = query.toLowerCase().split(/\s+/).filter(Boolean).map((word) => {
      const compare = /^([a-z_0-9]+)(<=|>=|<|>|=)(.+)$/.exec(word);
      if (!compare) return (run) => run.text.includes(word);
      const [, key, sign, wanted] = compare;
      return (run) => {
        const known = Object.keys(run.tags).find((tag) => tag === key) ?? Object.keys(run.tags).find((tag) => tag.startsWith(key));
        if (known === undefined) return false;
        const value = run.tags[known].toLowerCase();
        const [a, b] = [Number(value), Number(wanted)];
        switch (sign) {
          case "<": return a < b;
          case ">": return a > b;
          case "<=": return a <= b;
          case ">=": return a >= b;
          default: return value === wanted || (isFinite(b) && a === b);
        }
      };
    });
    return (run) => words.every((word) => word(run));
  };

  // ---------------------------------------------------------------- a run found by typing
  const finder = () => {
    const header = document.querySelector("header.site");
    if (!header) return;
    const LISTED = 12;
    const input = make("input", {
      type: "search", id: "find-run", placeholder: "Find a run", autocomplete: "off", spellcheck: "false", role: "combobox",
      "aria-label": "Find a run by name or tag", "aria-autocomplete": "list", "aria-expanded": "false", "aria-controls": "found-runs",
    });
    const list = make("ul", { id: "found-runs", role: "listbox", "aria-label": "Runs found", hidden: "" });
    header.append(make("div", { class: "finder" }, input, list));
    let at = -1;
    const close = () => { list.hidden = true; input.setAttribute("aria-expanded", "false"); input.removeAttribute("aria-activedescendant"); at = -1; };
    const choose = (next) => {
      const options = list.querySelectorAll("[role=option]");
      if (!options.length) return;
      at = (next + options.length) % options.length;
      options.forEach((option, k) => option.setAttribute("aria-selected", String(k === at)));
      options[at].scrollIntoView({ block: "nearest" });
      input.setAttribute("aria-activedescendant", options[at].id);
    };
    const look = async () => {
      const query = input.value.trim();
      if (!query) return close();
      const found = (await runs()).filter(matcher(query));
      if (input.value.trim() !== query) return;
      at = -1;
      list.replaceChildren(...found.slice(0, LISTED).map((run, k) => {
        const tags = ["sample", "environment", "voltage_v", "relative_humidity_percent"];
        const units = { voltage_v: " V", relative_humidity_percent: " % RH" };
        const words = tags.filter((key) => run.tags[key] !== undefined).map((key) => run.tags[key] + (units[key] || ""));
        const link = make("a", { href: run.href, tabindex: "-1" }, run.name, make("small", {}, words.join(", ")));
        return make("li", { role: "option", id: "found-run-" + k, "aria-selected": "false" }, link);
      }));
      if (found.length > LISTED) list.append(make("li", { class: "more", role: "presentation" }, `${found.length - LISTED} more: type more of it`));
      if (!found.length) list.append(make("li", { class: "more", role: "presentation" }, "No run has all of this."));
      list.hidden = false;
      input.setAttribute("aria-expanded", "true");
      say(`${found.length} runs found`);
    };
    input.addEventListener("focus", () => runs(), { once: true });
    input.addEventListener("input", look);
    input.addEventListener("keydown", (event) => {
      if (event.key === "ArrowDown") choose(at + 1);
      else if (event.key === "ArrowUp") choose(at < 0 ? -1 : at - 1);
      else if (event.key === "Escape") { input.value = ""; close(); }
      else if (event.key === "Enter") list.querySelectorAll("[role=option] a")[Math.max(at, 0)]?.click();
      else return;
      event.preventDefault();
    });
    document.addEventListener("click", (event) => { if (!event.target.closest(".finder") || event.target.closest("#found-runs a")) close(); });
    document.addEventListener("keydown", (event) => {
      const typing = event.target.closest?.("input, select, textarea, [contenteditable]");
      if (event.key === "/" && !typing && !event.ctrlKey && !event.metaKey) { input.focus(); event.preventDefault(); }
    });
  };

  // ---------------------------------------------------------------- tables
  const FEWEST_SORTED = 3, FEWEST_FILTERED = 15, AT_ONCE = 100;
  const sortable = (table) => {
    const body = table.tBodies[0], head = table.tHead?.rows[0];
    if (!body || !head || table.tHead.rows.length > 1 || table.matches(".matrix")) return;
    const rows = [...body.rows];
    if (rows.length < FEWEST_SORTED || rows.some((row) => [...row.cells].some((cell) => cell.rowSpan > 1 || cell.colSpan > 1))) return;
    const asRead = (cell) => {
      const copy = cell.cloneNode(true);
      copy.querySelectorAll("sup").forEach((mark) => mark.remove());
      copy.querySelectorAll("br").forEach((end) => { while (end.nextSibling) end.nextSibling.remove(); });
      return copy.textContent.trim();
    };
    let visible = rows, limit = rows.length > 2 * AT_ONCE ? AT_ONCE : Infinity;
    const show = () => {
      const wanted = new Set(visible.slice(0, limit));
      rows.forEach((row) => { row.hidden = !wanted.has(row); });
      more.hidden = visible.length <= limit;
      more.textContent = `Show all ${visible.length} rows`;
    };
    const more = make("button", { type: "button", class: "tool", hidden: "" });
    more.addEventListener("click", () => { limit = Infinity; show(); });
    [...head.cells].forEach((cell, column) => {
      if (!cell.textContent.trim()) return;
      const button = make("button", { type: "button", class: "sort" });
      button.append(...cell.childNodes);
      cell.append(button);
      cell.setAttribute("aria-sort", "none");
      button.addEventListener("click", () => {
        const up = cell.getAttribute("aria-sort") !== "ascending";
        [...head.cells].forEach((other) => other.hasAttribute("aria-sort") && other.setAttribute("aria-sort", "none"));
        cell.setAttribute("aria-sort", up ? "ascending" : "descending");
        const texts = new Map(rows.map((row) => [row, asRead(row.cells[column])]));
        const numeric = cell.classList.contains("number") || rows.every((row) => /^[<>]? ?[−-]?\d[\d.]*$/.test(texts.get(row)));
        const keys = new Map(rows.map((row) => [row, numeric ? numberIn(texts.get(row)) : texts.get(row)]));
        const order = (a, b) => {
          const [x, y] = [keys.get(a), keys.get(b)];
          if (!numeric) return (up ? 1 : -1) * x.localeCompare(y, "en", { numeric: true });
          // What is no number stands last either way.
          if (isNaN(x) || isNaN(y)) return isNaN(x) - isNaN(y);
          return up ? x - y : y - x;
        };
        rows.sort(order);
        visible = rows.filter((row) => visible.includes(row));
        body.append(...rows);
        show();
        say(`sorted by ${button.textContent.trim()}, ${up ? "ascending" : "descending"}`);
      });
    });
    const place = table.closest(".scroll") || table;
    place.after(more);
    if (rows.length >= FEWEST_FILTERED) {
      const input = make("input", { type: "search", placeholder: "Filter rows", autocomplete: "off", "aria-label": "Filter the rows of this table" });
      const count = make("span", { role: "status" });
      const texts = new Map(rows.map((row) => [row, row.textContent.toLowerCase()]));
      input.addEventListener("input", () => {
        const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
        visible = rows.filter((row) => words.every((word) => texts.get(row).includes(word)));
        show();
        count.textContent = words.length ? `${visible.length} of ${rows.length} rows` : "";
      });
      place.before(make("p", { class: "tools" }, input, count));
    }
    show();
  };

  // ---------------------------------------------------------------- shapes
  // Stretches of path data as lists of absolute points; `z` closes one.
  const parsed = (data) => {
    const stretches = [];
    let points, x = 0, y = 0, command = "M";
    const numbers = /([MmLlHhVvz])|(-?\d*\.?\d+(?:e-?\d+)?)/g;
    let match, pair = [];
    while ((match = numbers.exec(data))) {
      if (match[1]) {
        command = match[1];
        if (command === "z" && points) points.closed = true;
        continue;
      }
      const number = Number(match[2]);
      if (command === "h" || command === "v") {
        if (command === "h") x += number; else y += number;
        points.push([x, y]);
        continue;
      }
      pair.push(number);
      if (pair.length < 2) continue;
      if (command === "M" || command === "L") [x, y] = pair; else { x += pair[0]; y += pair[1]; }
      if (command === "M" || command === "m") {
        stretches.push((points = []));
        command = command === "M" ? "L" : "l";
      }
      points.push([x, y]);
      pair = [];
    }
    return stretches;
  };
  // Height at a place across of lines whose vertices go from left to right: straight between them, as they are drawn, on the
  // scales of the axes. Of an upright part its end counts; null where no line is.
  const heightAt = (lines, px) => {
    let found = null;
    for (const points of lines) {
      if (points.length === 1 && points[0][0] === px) found = points[0][1];
      for (let k = 1; k < points.length; k++) {
        const [[x0, y0], [x1, y1]] = [points[k - 1], points[k]];
        if (px >= x0 && px <= x1) found = x1 > x0 ? y0 + ((px - x0) / (x1 - x0)) * (y1 - y0) : y1;
      }
    }
    return found;
  };
  const written = (stretches) => stretches.map((points) =>
    "M" + points.map(([x, y]) => x.toFixed(1) + " " + y.toFixed(1)).join("L") + (points.closed ? "z" : points.length === 1 ? "h0" : "")).join("");
  const SMALL = 150; // a closed shape not larger than this, in tenths of a pixel, is a mark

  // `3-7 9` as 3 4 5 6 7 9.
  const listOf = (text) => (text || "").split(" ").filter(Boolean).flatMap((part) => {
    const [from, to = from] = part.split("-").map(Number);
    return Array.from({ length: to - from + 1 }, (_, k) => from + k);
  });

  class Series {
    constructor(element, panel) {
      this.element = element;
      this.name = element.dataset.s;
      // Hidden by its key, and by the toolbox.
      this.keyed = false;
      this.boxed = false;
      this.shapes = (element.tagName === "g" ? [...element.querySelectorAll("path, circle")] : [element]).map((shape) => {
        if (shape.tagName === "circle") {
          const at = [Number(shape.getAttribute("cx")), Number(shape.getAttribute("cy"))];
          return { shape, ring: true, stretches: [[at]], marks: [at] };
        }
        // Scattered dots count in pixels.
        const unit = shape.hasAttribute("transform") ? 10 : 1;
        const stretches = parsed(shape.getAttribute("d")).map((points) => Object.assign(points.map(([x, y]) => [unit * x, unit * y]), { closed: points.closed }));
        if (unit > 1) {
          shape.removeAttribute("transform");
          shape.setAttribute("stroke-width", unit * Number(shape.getAttribute("stroke-width")));
          shape.setAttribute("d", written(stretches));
        }
        const small = (points) => {
          const [xs, ys] = [points.map((p) => p[0]), points.map((p) => p[1])];
          const mid = [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
          return points.closed && Math.max(...xs) - Math.min(...xs) < SMALL && Math.max(...ys) - Math.min(...ys) < SMALL ? mid : null;
        };
        return { shape, dots: shape.classList.contains("dots"), stretches, small: stretches.map(small) };
      });
      const marks = this.shapes.flatMap((s) => (s.dots ? s.stretches.flat() : s.ring ? s.marks : s.small.filter(Boolean)));
      // What is drawn of each mark: the mark itself, then its bars.
      this.parts = this.shapes.flatMap((s) => (s.dots ? s.stretches.flat() : s.ring ? s.stretches : s.stretches.filter((_, k) => s.small[k]))).map((part) => [part]);
      const lines = this.shapes.filter((s) => s.shape.classList.contains("s") && !s.ring).flatMap((s) => s.stretches);
      // What has no marks is a line, which is read anywhere along it; its vertices are where arrow keys stop.
      this.lines = marks.length ? null : lines.filter((points) => !points.closed);
      this.points = (marks.length ? marks : lines.flat()).map(([px, py]) => ({ px, py }));
      const owners = listOf(element.dataset.r);
      this.points.forEach((point, k) => { if (owners.length) point.run = owners[k]; });
      // Bars over marks are their intervals.
      const [upright, level] = [new Map(), new Map()];
      if (marks.length) for (const bar of lines.filter((points) => points.length === 2)) {
        const [[x0, y0], [x1, y1]] = bar;
        if (x0 === x1) upright.set(x0, [...(upright.get(x0) || []), Object.assign([Math.max(y0, y1), Math.min(y0, y1)], { bar })]);
        else if (y0 === y1) level.set(y0, [...(level.get(y0) || []), Object.assign([Math.min(x0, x1), Math.max(x0, x1)], { bar })]);
      }
      this.points.forEach((point, k) => {
        point.bar = upright.get(Math.round(point.px))?.find(([low, high]) => point.py <= low + 2 && point.py >= high - 2);
        point.side = level.get(Math.round(point.py))?.find(([low, high]) => point.px >= low - 2 && point.px <= high + 2);
        this.parts[k]?.push(...[point.bar, point.side].filter(Boolean).map((end) => end.bar));
      });
      this.panel = panel;
    }
    get hidden() { return this.keyed || this.boxed; }
    display() { this.element.style.display = this.hidden ? "none" : ""; }
    place(to) {
      const off = new Set(this.points.flatMap((point, k) => (point.off ? this.parts[k] || [] : [])));
      for (const { shape, ring, dots, stretches, small } of this.shapes) {
        if (ring) {
          const [x, y] = to(stretches[0][0]);
          for (const [key, value] of Object.entries({ cx: x, cy: y, display: off.has(stretches[0]) ? "none" : "inline" })) shape.setAttribute(key, value);
          continue;
        }
        shape.setAttribute("d", written(stretches.flatMap((points, k) => {
          const mid = small?.[k];
          if (off.has(points)) return [];
          if (!mid) return [Object.assign((dots ? points.filter((point) => !off.has(point)) : points).map(to), { closed: points.closed })];
          const [nx, ny] = to(mid);
          return [Object.assign(points.map(([x, y]) => [x + nx - mid[0], y + ny - mid[1]]), { closed: true })];
        }).filter((points) => points.length)));
      }
      this.light();
    }
    // Points that stand out are drawn once more over their dimmed series.
    light() {
      this.lit?.remove();
      this.lit = null;
      const { panel } = this;
      if (this.hidden || !this.points.some((point) => point.lit && !point.off)) return;
      this.lit = document.createElementNS(SVG, "g");
      this.points.forEach((point, k) => {
        const [x, y] = panel.to([point.px, point.py]), [mark] = this.parts[k] || [];
        if (!mark || !point.lit || point.off || x < panel.left || x > panel.right) return;
        const { shape, dots, ring } = this.shapes.find((s) => (s.dots ? s.stretches.some((points) => points.includes(mark)) : s.stretches.includes(mark)));
        const copy = shape.cloneNode();
        if (!ring) copy.setAttribute("d", written([dots ? [[x, y]] : Object.assign(mark.map(([px, py]) => [px + x - point.px, py + y - point.py]), { closed: true })]));
        this.lit.append(copy);
        draw("circle", { class: "s k-5", "stroke-width": 22, cx: x, cy: y, r: 72 }, this.lit);
      });
      this.element.after(this.lit);
    }
  }

  const titleParts = (title) => /^(.*?)(?: \(([^()]*)\))?$/.exec(title || "");
  class Panel {
    constructor(element, chart) {
      // Axes state their ranges; a panel without one across shows that of the figure's first, if it states no other.
      const axis = (name) => element.querySelector(`.axes[data-${name}]`) || chart.svg.querySelector(`.axes[data-${name}]`);
      const numbers = (name) => (element.dataset[name] ??= axis(name).dataset[name]).split(" ").map(Number);
      this.element = element;
      this.chart = chart;
      [this.left, this.top, this.right, this.bottom] = numbers("f");
      const range = ([scale, low, high, unit, before]) => ({ scale, low, high, unit, before });
      this.x = range(numbers("x"));
      this.y = range(numbers("y"));
      this.view = null;
      // Titles stay where they are while lines and labels are drawn anew.
      const own = [...element.querySelectorAll(":scope > text, .axis")];
      element.append(...own);
      const [axes, ...more] = element.querySelectorAll(".axes");
      more.forEach((other) => { axes.append(...other.childNodes); other.remove(); });
      this.axes = axes;
      const upward = own.find((text) => text.matches(".up"));
      [, this.quantity, this.unit = ""] = titleParts(upward?.textContent);
      const across = own.filter((text) => !text.matches(".up")).find((text) => Math.abs(Number(text.getAttribute("x")) - (this.left + this.right) / 2) < 40);
      this.xTitle = across?.textContent || "";
      this.labelled = !!this.xTitle;
      this.series = [...element.querySelectorAll(":scope > [data-s]")].map((s) => new Series(s, this));
    }
    // Position on the scale of a drawn place, as it was first drawn.
    xAt(px) { return this.x.low + ((px - this.left) / (this.right - this.left)) * (this.x.high - this.x.low); }
    yAt(py) { return this.y.low + ((this.bottom - py) / (this.bottom - this.top)) * (this.y.high - this.y.low); }
    get range() { return this.view || { x: [this.x.low, this.x.high], y: [this.y.low, this.y.high] }; }
    // Where a place of the first drawing stands now.
    to([px, py]) {
      const { x, y } = this.range;
      return [this.left + ((this.xAt(px) - x[0]) / (x[1] - x[0])) * (this.right - this.left),
        this.bottom - ((this.yAt(py) - y[0]) / (y[1] - y[0])) * (this.bottom - this.top)];
    }
    // Where a place across the present drawing stood in the first one.
    from(px) { return this.left + ((this.position(px) - this.x.low) / (this.x.high - this.x.low)) * (this.right - this.left); }
    position(px) { const { x } = this.range; return x[0] + ((px - this.left) / (this.right - this.left)) * (x[1] - x[0]); }
    show(x) {
      if (!x) { this.view = null; } else {
        const inside = this.series.filter((s) => s.name && !s.hidden).flatMap((s) => s.points)
          .filter((p) => !p.off && this.xAt(p.px) >= x[0] && this.xAt(p.px) <= x[1]).flatMap((p) => [p.py, ...(p.bar || [])].map((py) => this.yAt(py)));
        let y = [this.y.low, this.y.high];
        if (inside.length > 1) {
          const [low, high] = [Math.min(...inside), Math.max(...inside)];
          const room = 0.08 * (high - low) || 0.02 * (this.y.high - this.y.low);
          y = [low - room, high + room];
        }
        this.view = { x, y };
      }
      if (!this.drawn) this.drawn = this.axes.innerHTML;
      const clip = this.chart.clip(this);
      this.series.forEach((s) => {
        s.place((point) => this.to(point));
        if (this.view) s.element.setAttribute("clip-path", `url(#${clip})`); else s.element.removeAttribute("clip-path");
      });
      if (!this.view) this.axes.innerHTML = this.drawn; else this.drawAxes();
    }
    drawAxes() {
      const { x, y } = this.range;
      this.axes.replaceChildren();
      const across = (at) => this.left + ((at - x[0]) / (x[1] - x[0])) * (this.right - this.left);
      const up = (at) => this.bottom - ((at - y[0]) / (y[1] - y[0])) * (this.bottom - this.top);
      const [xs, ys] = [ticks(this.x, ...x, 6, zoneIn(this.xTitle)), ticks(this.y, ...y, 5)];
      const wide = this.right - this.left;
      draw("path", { class: "s k-grid", "stroke-width": 10, d: ys.map((t) => `M${this.left} ${up(t.at).toFixed(0)}h${wide}`).join("") }, this.axes);
      draw("path", { class: "s k-muted", "stroke-width": 10, d: `M${this.left} ${this.bottom}h${wide}` + xs.map((t) => `M${across(t.at).toFixed(0)} ${this.bottom}v40`).join("") }, this.axes);
      const labels = draw("g", { class: "f k-muted", "font-size": 110, "text-anchor": "end" }, this.axes);
      ys.forEach((t) => { draw("text", { x: this.left - 60, y: up(t.at) + 40 }, labels).textContent = t.label; });
      if (!this.labelled) return;
      const below = draw("g", { class: "f k-muted", "font-size": 110, "text-anchor": "middle" }, this.axes);
      xs.forEach((t) => { draw("text", { x: across(t.at), y: this.bottom + 151 }, below).textContent = t.label; });
    }
    // Digits follow the first drawing, however far it is enlarged: nothing finer is known of its shapes. `parts` are of the
    // whole axis: tenths of a pixel, or half pixels where a thinned line is read.
    number(axis, position, parts = 2000) {
      const { scale } = axis, step = Math.abs(axis.high - axis.low) / parts;
      if (scale === 2) return moment(position, zoneIn(this.xTitle));
      if (scale === 4) return shown(valueAt(axis, position), Math.abs(valueAt(axis, position + step) - valueAt(axis, position)));
      return scale === 1 ? shown(10 ** position, 10 ** position * 2.3 * step) : shown(position, step);
    }
  }

  // Number at a position of an axis, and the position of a number.
  const valueAt = ({ scale, unit, before }, at) => (scale === 1 ? 10 ** at : scale === 4 ? (at < 0 ? at / (before || 1) : unit * (10 ** at - 1)) : at);
  const positionOf = ({ scale, unit, before }, value) => (scale === 1 ? Math.log10(value) : scale === 4 ? (value < 0 ? value * before : Math.log10(1 + value / unit)) : value);
  const ticks = (axis, low, high, wanted, zone) => {
    const { scale } = axis, span = high - low;
    if (scale === 2) {
      const steps = [60, 300, 900, 3600, 10800, 21600, 43200, 86400, 172800, 604800, 1209600, 2629800, 7889400, 31557600];
      const step = steps.find((s) => span / s <= wanted) || steps[steps.length - 1];
      return listed(low, high, step).map((at) => ({ at, label: step < 86400 ? moment(at, zone).slice(5) : moment(at, zone).slice(0, 10) }));
    }
    if (scale === 1 && span >= 1) {
      const every = Math.ceil(span / 7);
      return listed(low, high, every).map((at) => ({ at, label: Math.abs(at) < 5 ? fixed(10 ** at, Math.max(0, -at)) : "10" + raised(at) }));
    }
    const [from, to] = [valueAt(axis, low), valueAt(axis, high)];
    if (scale === 4 && span >= 1) {
      const decades = listed(Math.log10(2 * axis.unit), Math.log10(to), 1).map((power) => 10 ** power).filter((value) => value >= from);
      return [...(low <= 0 ? [0] : []), ...decades].map((value) => ({ at: positionOf(axis, value), label: minus(String(Number(value.toPrecision(1)))) }));
    }
    const rough = (to - from) / wanted, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= rough * (1 - 1e-9));
    const decimals = Math.min(9, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
    return listed(from, to, step).map((value) => ({ at: positionOf(axis, value), label: fixed(value, decimals) }));
  };
  const listed = (low, high, step) => {
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && found.length < 100; k++) found.push(k * step);
    return found;
  };

  // ---------------------------------------------------------------- what is shown, in the address
  // `#place&zoom=figure:low:high&by=sample&only=air`: a place of the page, then what was chosen on it. Behind the sign, for a
  // page opened from a disk may change nothing else of its address.
  // What goes with a reader to the next page: what the toolbox says stands out, is hidden, and has another name.
  const KEPT = ["mark", "hide", "rename"];
  const state = (() => {
    const [place = "", ...parts] = location.hash.slice(1).split("&");
    const known = { place: decodeURIComponent(place) };
    for (const part of parts) { const [key, ...value] = part.split("="); known[key] = decodeURIComponent(value.join("=")); }
    return known;
  })();
  const remember = (change) => {
    Object.assign(state, change);
    const parts = ["zoom", "by", "only", ...KEPT].filter((key) => state[key]).map((key) => key + "=" + encodeURIComponent(state[key]));
    const address = [encodeURIComponent(state.place), ...parts].join("&");
    history.replaceState(null, "", address ? "#" + address : location.pathname.split("/").pop());
  };

  // ---------------------------------------------------------------- figures that are saved
  const COPIED = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "opacity", "font-size", "font-family", "text-anchor", "transform", "transform-origin"];
  // The figure as a file of its own: what the style sheet says of it stands in it.
  const alone = (svg) => {
    const copy = svg.cloneNode(true);
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    const markers = new Set();
    const own = [svg, ...svg.querySelectorAll("*")], copies = [copy, ...copy.querySelectorAll("*")];
    own.forEach((element, k) => {
      const style = getComputedStyle(element), to = copies[k];
      if (style.display === "none" || element.matches(".cursor, .band, .moving")) { to.dataset.gone = "1"; return; }
      for (const name of COPIED) { const value = style.getPropertyValue(name); if (value && value !== "none" || name === "fill" || name === "stroke") to.style.setProperty(name, value); }
      if (element.matches(".dots")) {
        const id = /#([\w-]+)/.exec(style.markerMid)?.[1];
        if (id) { markers.add(id); to.style.setProperty("marker", `url(#${id})`); }
      }
      for (const name of ["class", "tabindex", "data-f", "data-s", "data-r", "data-x", "data-y", "data-film", "aria-roledescription"]) to.removeAttribute(name);
    });
    copy.querySelectorAll("[data-gone]").forEach((element) => element.remove());
    const defs = document.createElementNS(SVG, "defs");
    for (const id of markers) {
      const from = document.getElementById(id), marker = from.cloneNode(true);
      marker.firstElementChild.style.fill = getComputedStyle(from.firstElementChild).fill;
      defs.append(marker);
    }
    const ground = document.createElementNS(SVG, "rect");
    for (const [key, value] of Object.entries({ width, height, fill: getComputedStyle(document.body).backgroundColor })) ground.setAttribute(key, value);
    copy.prepend(defs, ground);
    for (const [key, value] of Object.entries({ xmlns: SVG, width: width / 10, height: height / 10, role: "img", style: "" })) copy.setAttribute(key, value);
    copy.style.setProperty("font-family", "sans-serif");
    copy.style.setProperty("font-size", "110px");
    copy.style.setProperty("text-anchor", "end");
    return new XMLSerializer().serializeToString(copy);
  };
  const quoted = (text) => (/[",\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text);
  // Points as they are drawn, so that they have the resolution of the drawing.
  const points = async (chart) => {
    const all = chart.byRun ? await runs() : [];
    const rows = [["panel", "series", "run", "x", "y", "y_low_95", "y_high_95"]];
    for (const panel of chart.panels) for (const series of panel.series.filter((s) => s.name && !s.hidden)) for (const point of series.points.filter((p) => !p.off)) {
      const number = (axis, at) => (axis.scale === 3 ? "" : String(Number(valueAt(axis, at).toPrecision(5))));
      const ends = point.bar ? point.bar.map((py) => number(panel.y, panel.yAt(py))) : ["", ""];
      const title = panel.quantity + (panel.unit ? ` (${panel.unit})` : "") + (panel.xTitle ? ` over ${panel.xTitle}` : "");
      rows.push([title, toolbox.rename(series.name), toolbox.rename(all[point.run]?.name ?? ""), number(panel.x, panel.xAt(point.px)), number(panel.y, panel.yAt(point.py)), ...ends]);
    }
    // What a program of tables would take for a formula is text.
    return rows.map((row) => row.map((cell) => quoted(/^[=+@]/.test(cell) ? "'" + cell : cell)).join(",")).join("\n") + "\n";
  };
  // The readings of a run as they are stored, from a file that goes with the page; null where the figure shows none, or where the
  // browser cannot unpack them: then what is drawn is saved.
  let unpacked = null;
  const unpack = async () => {
    await new Promise((resolve, reject) => {
      const script = make("script", { src: root + "readings/" + location.pathname.split("/").pop().replace(/\.html$/, "") + ".js" });
      script.onload = resolve;
      script.onerror = reject;
      document.head.append(script);
    });
    const bytes = Uint8Array.from(atob(window.ieapReadings), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).text();
  };
  const readings = async (chart) => {
    const wanted = chart.svg.closest("[data-readings]")?.dataset.readings;
    if (!wanted) return null;
    try { unpacked ??= await unpack(); } catch { return null; }
    const [head, ...lines] = unpacked.trimEnd().split("\n");
    return [head, ...lines.filter((line) => line.startsWith(wanted + ","))].join("\n") + "\n";
  };
  const save = (name, type, content) => {
    const url = URL.createObjectURL(new Blob([content], { type }));
    make("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  };
  const picture = (svg) => new Promise((resolve, reject) => {
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map((side) => Number(side) / 5);
    const image = new Image();
    image.onload = () => {
      const canvas = make("canvas", { width, height });
      canvas.getContext("2d").drawImage(image, 0, 0, width, height);
      canvas.toBlob(resolve, "image/png");
    };
    image.onerror = () => reject(new Error("the picture could not be drawn"));
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(alone(svg));
  });
  // What a figure is saved as, by the ending of the file.
  const savers = {
    svg: async (chart) => ["image/svg+xml", alone(chart.svg)],
    png: async (chart) => ["image/png", await picture(chart.svg)],
    csv: async (chart) => ["text/csv", (await readings(chart)) ?? (await points(chart))],
  };
  const addSaves = (chart) => {
    if (chart.saves) return;
    const button = (text, name, act) => {
      const made = make("button", { type: "button", class: "tool", "aria-label": name }, text);
      made.addEventListener("click", act);
      return made;
    };
    const title = chart.svg.getAttribute("aria-label").split(". ")[0];
    const tools = Object.entries(savers).map(([ending, saver]) =>
      button(ending.toUpperCase(), `Save as ${ending.toUpperCase()}: ${title}`, async () => save(chart.svg.id + "." + ending, ...(await saver(chart)))));
    const link = button("Link", `Link to this figure: ${title}`, () => {
      remember({ place: chart.svg.id });
      navigator.clipboard?.writeText(location.href).then(() => say("address copied"), () => say("the address bar has it"));
    });
    chart.saves = make("div", { class: "saves" }, make("div", {}, ...tools, link));
    chart.svg.before(chart.saves);
    const leave = (event) => {
      const to = event.relatedTarget;
      if (to === chart.svg || chart.saves?.contains(to) || chart.saves?.contains(document.activeElement) || document.activeElement === chart.svg) return;
      chart.saves?.remove();
      chart.saves = null;
    };
    for (const element of [chart.svg, chart.saves]) for (const kind of ["pointerleave", "focusout"]) element.addEventListener(kind, leave);
  };
  const nameFigure = (svg) => {
    if (svg.id) return;
    const words = svg.getAttribute("aria-label").split(". ")[0].toLowerCase().normalize("NFKD").replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 60);
    let id = "figure-" + words;
    for (let k = 2; document.getElementById(id); k++) id = `figure-${words}-${k}`;
    svg.id = id;
  };

  // ---------------------------------------------------------------- charts
  const charts = [];
  const box = make("div", { class: "readout", "aria-hidden": "true", hidden: "" });
  document.body.append(box);
  const hide = () => { box.hidden = true; charts.forEach((chart) => chart.cursor?.setAttribute("d", "")); };
  // What is scrolled or laid out anew no longer stands where it was read.
  let readAt = 0;
  addEventListener("scroll", () => { if (Math.abs(scrollY - readAt) > 1) hide(); }, { passive: true });
  addEventListener("resize", hide);
  const REACH = 200; // a reading this near to a place, in tenths of a pixel, is read there
  const HELP = "Arrow keys read values, plus and minus zoom, Escape shows all.";

  class Chart {
    constructor(svg) {
      this.svg = svg;
      this.panels = [...svg.querySelectorAll("[data-f]")].map((g) => new Panel(g, this)).filter((p) => p.series.some((s) => s.name));
      if (!this.panels.length) return;
      const last = this.panels[this.panels.length - 1];
      this.panels.forEach((p) => { if (!p.xTitle) p.xTitle = last.xTitle; });
      // Axes of the same quantity go together.
      this.link = last.x.scale === 3 || !last.xTitle ? null : [last.x.scale, last.x.unit, last.x.before, last.xTitle].join();
      this.byRun = this.panels.some((p) => p.series.some((s) => s.points.some((point) => point.run !== undefined)));
      svg.setAttribute("tabindex", "0");
      svg.setAttribute("role", "application");
      svg.setAttribute("aria-roledescription", "chart");
      svg.classList.add("live");
      this.cursor = draw("path", { class: "cursor", d: "" }, svg);
      nameFigure(svg);
      for (const kind of ["pointerenter", "focus"]) svg.addEventListener(kind, () => addSaves(this));
      this.listen();
      charts.push(this);
    }
    clip(panel) {
      const id = panel.clipId ??= `clip-${charts.indexOf(this)}-${this.panels.indexOf(panel)}`;
      if (!document.getElementById(id)) {
        const clip = draw("clipPath", { id }, this.svg);
        draw("rect", { x: panel.left, y: panel.top, width: panel.right - panel.left, height: panel.bottom - panel.top }, clip);
      }
      return id;
    }
    at(event) {
      const matrix = this.svg.getScreenCTM();
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      const reach = 60;
      const panel = this.panels.find((p) => point.y >= p.top - reach && point.y <= p.bottom + reach && point.x >= p.left - reach && point.x <= p.right + reach);
      return panel && { panel, px: Math.min(Math.max(point.x, panel.left), panel.right), py: point.y };
    }
    listen() {
      const { svg } = this;
      let from = null, band = null;
      svg.addEventListener("pointermove", (event) => {
        const here = this.at(event);
        if (from && here) {
          const [a, b] = [from.px, here.px].sort((p, q) => p - q);
          band ??= draw("rect", { class: "band" }, svg);
          for (const [key, value] of Object.entries({ x: a, y: from.panel.top, width: b - a, height: from.panel.bottom - from.panel.top })) band.setAttribute(key, value);
        }
        if (here) this.read(here, event); else this.leave();
      });
      svg.addEventListener("pointerleave", () => this.leave());
      svg.addEventListener("pointerdown", (event) => {
        if (event.pointerType === "touch" || event.button || !this.link) return;
        from = this.at(event) || null;
        if (from) { svg.setPointerCapture(event.pointerId); event.preventDefault(); svg.focus({ preventScroll: true }); }
      });
      const release = (event) => {
        const to = from && this.at(event);
        band?.remove();
        band = null;
        if (to && Math.abs(to.px - from.px) > 60) {
          const ends = [from.panel.position(from.px), from.panel.position(to.px)].sort((p, q) => p - q);
          this.zoom(ends);
          this.again(event);
        } else if (this.near?.run !== undefined && event.type === "pointerup" && event.pointerType !== "touch") {
          this.open();
        }
        from = null;
      };
      svg.addEventListener("pointerup", release);
      svg.addEventListener("pointercancel", release);
      svg.addEventListener("dblclick", (event) => { this.zoom(null); this.again(event); });
      svg.addEventListener("wheel", (event) => {
        // A page that is scrolled past a chart must not zoom it: only the chart in use does, or Ctrl says so.
        if (!this.link || (!event.ctrlKey && document.activeElement !== svg)) return;
        const here = this.at(event);
        if (!here) return;
        event.preventDefault();
        this.scale(Math.exp(0.002 * event.deltaY), here.panel.position(here.px));
        this.again(event);
      }, { passive: false });
      svg.addEventListener("keydown", (event) => this.key(event));
      svg.addEventListener("focus", () => { if (svg.matches(":focus-visible")) say(HELP); });
      svg.addEventListener("blur", () => this.leave());
    }
    scale(factor, about) {
      const panel = this.panels[0];
      const [low, high] = panel.range.x;
      const ends = [about - factor * (about - low), about + factor * (high - about)].map((end) => Math.min(Math.max(end, panel.x.low), panel.x.high));
      const whole = panel.x.high - panel.x.low;
      if (ends[1] - ends[0] < 1e-4 * whole) return;
      this.zoom(ends[1] - ends[0] > 0.999 * whole ? null : ends);
    }
    zoom(ends) {
      if (!this.link) return;
      remember({ zoom: ends ? [this.svg.id, ...ends.map((end) => Number(end.toPrecision(6)))].join(":") : "" });
      // A readout of what stood there before would be wrong now.
      hide();
      charts.filter((chart) => chart.link === this.link).forEach((chart) => {
        chart.panels.forEach((panel) => panel.show(ends));
        chart.reset(!!ends);
      });
    }
    // Reads anew where the pointer is.
    again(event) { const here = this.at(event); if (here) this.read(here, event); else this.leave(); }
    reset(zoomed) {
      if (zoomed && !this.back) {
        this.back = make("button", { type: "button", class: "tool back" }, "Show all");
        this.back.addEventListener("click", () => { this.zoom(null); this.svg.focus(); });
        this.svg.after(this.back);
      } else if (!zoomed) { this.back?.remove(); this.back = null; }
    }
    key(event) {
      const panel = this.panels[0];
      const all = panel.series.filter((s) => s.name && !s.hidden).flatMap((s) => s.points).filter((p) => !p.off).sort((a, b) => a.px - b.px)
        .filter((p) => { const at = panel.xAt(p.px); return at >= panel.range.x[0] && at <= panel.range.x[1]; });
      const middle = () => panel.position(this.near ? panel.to([this.near.px, this.near.py])[0] : (panel.left + panel.right) / 2);
      const step = event.shiftKey ? 10 : 1;
      switch (event.key) {
        case "ArrowRight": case "ArrowLeft": {
          if (!all.length) return;
          const now = all.indexOf(this.near);
          const from = now < 0 && this.near ? Math.max(all.findIndex((p) => p.px >= this.near.px), 0) : 0;
          const next = now < 0 ? from : Math.min(Math.max(now + (event.key === "ArrowRight" ? step : -step), 0), all.length - 1);
          const [px, py] = panel.to([all[next].px, all[next].py]);
          this.read({ panel, px, py, point: all[next] }, null);
          break;
        }
        case "+": case "=": this.scale(0.5, middle()); break;
        case "-": this.scale(2, middle()); break;
        case "Escape": case "0": this.zoom(null); this.leave(); break;
        case "Enter": if (this.near?.run === undefined) return; this.open(); break;
        default: return;
      }
      event.preventDefault();
    }
    leave() { hide(); this.near = null; }
    // The page of the run that is nearest.
    async open() {
      const { run } = this.near, all = await runs([run]);
      if (all[run]) location.href = all[run].href;
    }
    nearest(panel, series, px, py) {
      let best = null, least = Infinity;
      for (const point of series.points) {
        const [x, y] = panel.to([point.px, point.py]);
        if (x < panel.left - 1 || x > panel.right + 1 || point.off) continue;
        const far = py === undefined ? Math.abs(x - px) : Math.hypot(x - px, y - py);
        if (far < least) { least = far; best = point; }
      }
      return best && { point: best, far: least, series };
    }
    async read(here, event) {
      const { panel } = here;
      const lines = [];
      const number = (p, py, parts) => p.number(p.y, p.yAt(py), parts) + (p.unit ? " " + p.unit : "");
      const across = (px) => {
        const [, name, unit = ""] = titleParts(panel.xTitle);
        return [name, panel.number(panel.x, panel.xAt(px)) + (unit && unit !== "UTC" ? " " + unit : unit ? " UTC" : "")];
      };
      const interval = (p, point) => (point.bar ? ` [${number(p, point.bar[0]).replace(" " + p.unit, "")}, ${number(p, point.bar[1]).replace(" " + p.unit, "")}]` : "");
      const single = this.byRun || panel.x.scale === 3;
      if (single) {
        const found = here.point ? { point: here.point, series: panel.series.find((s) => s.points.includes(here.point)) }
          : panel.series.filter((s) => s.name && !s.hidden).map((s) => this.nearest(panel, s, here.px, here.py)).filter(Boolean).sort((a, b) => a.far - b.far)[0];
        if (!found || found.far > 260) return this.leave();
        this.near = found.point;
        lines.push([found.series.name, ""]);
        lines.push([panel.quantity, number(panel, found.point.py) + interval(panel, found.point)]);
        if (panel.x.scale !== 3) lines.push(across(found.point.px));
        if (found.point.run !== undefined) {
          const run = (await runs([found.point.run]))[found.point.run];
          if (this.near !== found.point) return;
          if (run) lines[0] = [run.name, ""];
        }
        const [x, y] = panel.to([found.point.px, found.point.py]);
        this.cursor.setAttribute("d", `M${x - 70} ${y}a70 70 0 1 0 140 0a70 70 0 1 0-140 0`);
      } else {
        // The reading next to the pointer, and the lines at its place; where no reading is near, the lines at the pointer;
        // where there is neither, what is nearest.
        const seen = panel.series.filter((s) => s.name && !s.hidden);
        const nearestOf = (of) => of.map((s) => this.nearest(panel, s, here.px)).filter(Boolean).sort((a, b) => a.far - b.far)[0];
        const mark = nearestOf(seen.filter((s) => !s.lines)), px = panel.from(here.px);
        const onLine = seen.some((s) => s.lines && heightAt(s.lines, px) !== null);
        const first = here.point || (mark && mark.far < REACH ? mark.point : onLine ? { px, py: here.py } : nearestOf(seen)?.point);
        if (!first) return this.leave();
        this.near = first;
        lines.push(across(first.px));
        const at = panel.to([first.px, 0])[0];
        for (const p of this.panels) for (const series of p.series.filter((s) => s.name && !s.hidden)) {
          const name = (series.name === p.quantity || /^Residual/.test(series.name) ? "" : p.quantity + ", ") + series.name.toLowerCase();
          if (series.lines) {
            const py = heightAt(series.lines, p.from(at));
            if (py !== null) lines.push([name, number(p, py, 400)]);
            continue;
          }
          const found = this.nearest(p, series, at);
          if (!found || found.far > REACH) continue;
          // A reading at another place says where.
          const elsewhere = found.far > 10 && p.xTitle ? " at " + p.number(p.x, p.xAt(found.point.px)) : "";
          lines.push([name, number(p, found.point.py) + interval(p, found.point) + elsewhere]);
        }
        if (lines.length < 2) return this.leave();
        const position = panel.position(at);
        charts.filter((chart) => chart === this || (this.link && chart.link === this.link)).forEach((chart) => {
          chart.cursor.setAttribute("d", chart.panels.map((p) => {
            const x = p.left + ((position - p.range.x[0]) / (p.range.x[1] - p.range.x[0])) * (p.right - p.left);
            return x < p.left || x > p.right ? "" : `M${x.toFixed(1)} ${p.top}V${p.bottom}`;
          }).join(""));
        });
      }
      box.replaceChildren(...lines.map(([name, value]) => make("div", {}, make("span", {}, toolbox.rename(name)), make("b", {}, value))));
      box.hidden = false;
      readAt = scrollY;
      const place = event ? { x: event.clientX, y: event.clientY } : (() => {
        const [x, y] = panel.to([this.near.px, this.near.py]);
        return new DOMPoint(x, y).matrixTransform(this.svg.getScreenCTM());
      })();
      const wide = box.offsetWidth, high = box.offsetHeight;
      box.style.left = Math.max(4, place.x + 16 + wide > innerWidth ? place.x - wide - 16 : place.x + 16) + "px";
      box.style.top = Math.max(4, Math.min(place.y + 12, innerHeight - high - 4)) + "px";
      if (!event) say(lines.map((line) => line.join(" ").trim()).join("; "));
    }
  }

  // ---------------------------------------------------------------- legends: what can be hidden
  const swatch = (series) => {
    const shape = series.shapes.find((s) => s.dots) || series.shapes[0];
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", "0 0 200 100");
    svg.setAttribute("class", "swatch figure");
    svg.setAttribute("aria-hidden", "true");
    if (!shape) return svg;
    const mark = shape.shape.cloneNode();
    if (mark.tagName === "circle") for (const [key, at] of Object.entries({ cx: 100, cy: 50, r: 32 })) mark.setAttribute(key, at);
    else if (shape.dots) { mark.setAttribute("d", "M100 50h0"); mark.setAttribute("stroke-width", "70"); mark.removeAttribute("opacity"); }
    else if (shape.shape.classList.contains("s")) { mark.setAttribute("d", "M20 50h160"); mark.setAttribute("stroke-width", "30"); }
    else { mark.setAttribute("d", "M60 15h80v70h-80z"); }
    svg.append(mark);
    return svg;
  };
  const legend = (all, name, series) => {
    const button = make("button", { type: "button", class: "key", "aria-pressed": "true" }, swatch(series[0]), name);
    button.addEventListener("click", () => {
      const off = button.getAttribute("aria-pressed") === "true";
      button.setAttribute("aria-pressed", String(!off));
      series.forEach((s) => { s.keyed = off; s.display(); s.light(); });
      say(`${name} ${off ? "hidden" : "shown"}`);
    });
    return button;
  };
  const legends = () => {
    const sections = new Map();
    for (const chart of charts.filter((c) => !c.byRun && !c.svg.closest("[data-keyed]") && c.panels.every((p) => p.x.scale !== 3))) {
      const section = chart.svg.closest("section") || chart.svg.closest("figure") || chart.svg;
      if (!sections.has(section)) sections.set(section, []);
      sections.get(section).push(chart);
    }
    for (const of of sections.values()) {
      const named = new Map();
      for (const series of of.flatMap((c) => c.panels).flatMap((p) => p.series).filter((s) => s.name)) {
        if (!named.has(series.name)) named.set(series.name, []);
        named.get(series.name).push(series);
      }
      if (named.size < 2 || named.size > 24) continue;
      const bar = make("div", { class: "tools legend", role: "group", "aria-label": "Series shown" }, ...[...named].map(([name, series]) => legend(of, name, series)));
      const first = of[0].svg.closest(".panels") || of[0].svg.closest("figure") || of[0].svg;
      // Where the page has keys that cannot be pressed, these stand in their place.
      const still = first.previousElementSibling;
      if (still?.matches("p.legend") && still.children.length && [...still.children].every((child) => child.matches(".key"))) still.remove();
      first.before(bar);
    }
  };

  // ---------------------------------------------------------------- responses over their voltage
  // Lines that are named by their voltage are divided by it: what is linear in the voltage then falls together.
  const perVolt = () => {
    const place = document.querySelector("[data-per-volt]");
    const own = charts.filter((chart) => place?.contains(chart.svg));
    if (!own.length) return;
    const button = make("button", { type: "button", class: "tool", "aria-pressed": "false" }, "Divide by the voltage");
    const voltsOf = (series) => Number(series.name.replace("−", "-").split(/\s/)[0]);
    const upward = (panel) => panel.element.querySelector("text.up");
    const shapesOf = (panel) => panel.series.flatMap((series) => series.shapes.map(({ shape }) => shape));
    const keep = (panel) => ({ y: panel.y, quantity: panel.quantity, unit: panel.unit, title: upward(panel).textContent, axes: panel.axes.innerHTML, lines: shapesOf(panel).map((shape) => shape.getAttribute("d")) });
    let first = [];
    // Keys hold the series, which stay what they are.
    const take = (panel, { y, quantity, unit, title, axes, lines }) => {
      shapesOf(panel).forEach((shape, k) => shape.setAttribute("d", lines[k]));
      upward(panel).textContent = title;
      Object.assign(panel, { y, quantity, unit, view: null });
      panel.series.forEach((series) => Object.assign(series, new Series(series.element, panel), { keyed: series.keyed, boxed: series.boxed }));
      if (axes) panel.axes.innerHTML = axes; else panel.drawAxes();
      panel.drawn = panel.axes.innerHTML;
    };
    const divided = (panel) => {
      const value = (series, py) => panel.yAt(py) / voltsOf(series);
      const all = panel.series.flatMap((s) => s.points.map((point) => value(s, point.py))).filter(isFinite);
      const [low, high] = [Math.min(...all), Math.max(...all)], room = 0.05 * (high - low);
      const y = { scale: 0, low: low - room, high: high + room };
      const at = (series, [px, py]) => [px, panel.bottom - ((value(series, py) - y.low) / (y.high - y.low)) * (panel.bottom - panel.top)];
      const lines = panel.series.flatMap((series) => series.shapes.map(({ stretches }) => written(stretches.map((points) => points.map((p) => at(series, p))))));
      const [quantity, unit] = [panel.quantity + " per volt", panel.unit + "/V"];
      return { y, quantity, unit, title: `${quantity} (${unit})`, lines };
    };
    button.addEventListener("click", () => {
      const on = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(on));
      own.filter((chart) => chart.panels.some((panel) => panel.view)).forEach((chart) => chart.zoom(null));
      if (on) first = own.map((chart) => chart.panels.map(keep));
      own.forEach((chart, k) => {
        chart.panels.forEach((panel, j) => take(panel, on ? divided(panel) : first[k][j]));
      });
      say(on ? "divided by the voltage" : "as measured");
    });
    place.before(make("p", { class: "tools" }, button));
  };

  // ---------------------------------------------------------------- points grouped and filtered by tags
  const FORMS = ["M0-.5a.5.5 0 1 0 .01 0z", "M-.45-.45h.9v.9h-.9z", "M0-.6l.58 1.04h-1.16z", "M0-.66l.66.66-.66.66-.66-.66z", "M0 .6l.58-1.04h-1.16z"];
  const marker = (k) => {
    const id = `dot-k-${(k % 6) + 1}-${k % FORMS.length}`;
    if (!document.getElementById(id)) {
      const defs = document.querySelector(".dot-forms");
      const made = draw("marker", { id, overflow: "visible" }, defs);
      draw("path", { class: `f k-${(k % 6) + 1}`, d: FORMS[k % FORMS.length] }, made);
    }
    return id;
  };
  const byTags = async () => {
    const place = document.querySelector("[data-by-tags]");
    const own = charts.filter((chart) => chart.byRun);
    if (!place || !own.length) return;
    const panels = own.flatMap((chart) => chart.panels);
    for (const panel of panels) panel.points = panel.series.flatMap((s) => s.points.filter((p) => p.run !== undefined));
    const drawnRuns = new Set(panels.flatMap((p) => p.points.map((point) => point.run)));
    const all = await runs(drawnRuns);
    const keys = new Map();
    for (const run of drawnRuns) for (const [key, value] of Object.entries(all[run]?.tags || {})) {
      if (!keys.has(key)) keys.set(key, new Set());
      keys.get(key).add(value);
    }
    const MOST = 12;
    const usable = [...keys].filter(([, values]) => values.size > 1 && values.size <= MOST).map(([key]) => key).sort();
    const select = make("select", { id: "group-by" }, ...usable.map((key) => make("option", { value: key }, key)));
    if (usable.includes(place.dataset.byTags)) select.value = place.dataset.byTags;
    if (usable.includes(state.by)) select.value = state.by;
    const filter = make("input", { type: "search", id: "filter-runs", autocomplete: "off", list: "tag-values", placeholder: "air voltage_v=2.5 relative_humidity_percent>60" });
    filter.value = state.only || "";
    const words = make("datalist", { id: "tag-values" }, ...[...keys].filter(([, values]) => values.size <= 40).flatMap(([key, values]) => [...values].map((value) => make("option", { value: `${key}=${value}` }))));
    const count = make("span", { role: "status" });
    const chips = make("div", { class: "legend", role: "group", "aria-label": "Values shown" });
    const hidden = new Set();
    // The same order, and so the same colours, as without scripts.
    const first = [...document.querySelectorAll(".groups .key")].map((key) => key.textContent.trim());
    const rank = (value) => (first.includes(value) ? first.indexOf(value) : first.length);
    const groupOf = (run) => all[run]?.tags[select.value] ?? "not stated";
    const redraw = () => {
      const passes = matcher(filter.value), { hide } = toolbox;
      const values = [...new Set([...drawnRuns].map(groupOf))].sort((a, b) => rank(a) - rank(b) || a.localeCompare(b, "en", { numeric: true }));
      const shownRuns = new Set([...drawnRuns].filter((run) => all[run] && passes(all[run]) && !hide?.(all[run]) && !hidden.has(groupOf(run))));
      for (const panel of panels) {
        panel.series.filter((s) => s.points.some((p) => p.run !== undefined)).forEach((s) => s.element.remove());
        panel.series = panel.series.filter((s) => !s.points.some((p) => p.run !== undefined));
        values.forEach((value, k) => {
          const points = panel.points.filter((p) => shownRuns.has(p.run) && groupOf(p.run) === value);
          if (!points.length) return;
          const group = draw("g", { "data-s": value, "data-r": points.map((p) => p.run).join(" ") }, panel.element);
          const bars = points.flatMap((p) => [p.bar && [[p.px, p.bar[0]], [p.px, p.bar[1]]], p.side && [[p.side[0], p.py], [p.side[1], p.py]]]).filter(Boolean);
          if (bars.length) draw("path", { class: `s k-${(k % 6) + 1}`, "stroke-width": 10, d: written(bars) }, group);
          draw("path", { class: "dots", style: `marker:url(#${marker(k)})`, "stroke-width": 64, d: written([points.map((p) => [p.px, p.py])]) }, group);
          const series = new Series(group, panel);
          series.points = points;
          panel.series.push(series);
        });
        panel.show(panel.view?.x || null);
      }
      if (toolbox.mark || toolbox.hide) toolbox.paint(own);
      chips.replaceChildren(...values.map((value, k) => {
        const dot = document.createElementNS(SVG, "svg");
        for (const [key, attribute] of Object.entries({ viewBox: "0 0 100 100", class: "swatch figure dot", "aria-hidden": "true" })) dot.setAttribute(key, attribute);
        draw("path", { class: "dots", style: `marker:url(#${marker(k)})`, "stroke-width": 70, d: "M50 50h0" }, dot);
        const chip = make("button", { type: "button", class: "key", "aria-pressed": String(!hidden.has(value)) }, dot, value);
        chip.addEventListener("click", () => {
          if (!hidden.delete(value)) hidden.add(value);
          redraw();
          chips.querySelectorAll("button")[k]?.focus();
        });
        return chip;
      }));
      count.textContent = `${shownRuns.size} of ${drawnRuns.size} runs shown`;
    };
    select.addEventListener("change", () => { hidden.clear(); remember({ by: select.value }); redraw(); });
    filter.addEventListener("input", () => { remember({ only: filter.value.trim() }); redraw(); });
    place.append(
      make("label", { for: "group-by" }, "Colour by "), select,
      make("label", { for: "filter-runs" }, "Only runs with "), filter, words, count, chips);
    place.hidden = false;
    document.querySelectorAll(".groups").forEach((drawn) => { drawn.hidden = true; });
    toolbox.after.push(redraw);
    redraw();
  };

  // ---------------------------------------------------------------- tables that are taken along
  const BARRED = 3; // rows from which bars in cells tell anything
  const takeAlong = (table) => {
    const rows = [...table.rows].filter((row) => row.cells.length > 1);
    if (rows.length < 2) return;
    const text = (cell) => cell.innerText.replace(/\s+/g, " ").trim();
    const lines = (join) => rows.filter((row) => !row.hidden && !row.matches(".out")).map((row) => [...row.cells].filter((cell) => !cell.hidden).map((cell) => join(text(cell))));
    const button = (name, act) => {
      const made = make("button", { type: "button", class: "tool" }, name);
      made.addEventListener("click", act);
      return made;
    };
    const title = table.closest("section")?.querySelector("h2, h3")?.textContent.trim() || "table";
    const copy = button("Copy", () => navigator.clipboard?.writeText(lines((cell) => cell).map((line) => line.join("\t")).join("\n")).then(() => say("table copied")));
    // What a program of tables would take for a formula is text.
    const csv = button("CSV", () => save(title.toLowerCase().replace(/[^a-z0-9]+/g, "-") + ".csv", "text/csv",
      lines((cell) => quoted(/^[=+@]/.test(cell) ? "'" + cell : cell)).map((line) => line.join(",")).join("\n") + "\n"));
    const tools = make("p", { class: "tools take" }, copy, csv);
    (table.closest(".scroll") || table).after(tools);
    if (table.matches(".runs-table")) { bars(table); tools.append(columns(table), scatter(table, tools)); }
  };
  // A bar behind each number of the table of runs, from the smallest to the largest of its column, over the logarithm where
  // the column spans more than a decade.
  const bars = (table) => {
    [...table.tHead.rows[0].cells].forEach((head, at) => {
      const cells = [...table.tBodies[0].rows].map((row) => row.cells[at]);
      const numbers = cells.map((cell) => numberIn(cell.textContent));
      const known = numbers.filter(isFinite), low = Math.min(...known), high = Math.max(...known);
      if (!head.matches(".number") || known.length < BARRED || low === high) return;
      const scale = low > 0 && high > 10 * low ? Math.log : (x) => x;
      cells.forEach((cell, k) => {
        if (!isFinite(numbers[k])) return;
        const part = (scale(numbers[k]) - scale(low)) / (scale(high) - scale(low));
        cell.classList.add("barred");
        cell.style.setProperty("--part", (4 + 96 * part).toFixed(0) + "%");
      });
    });
  };
  const columns = (table) => {
    const heads = [...table.tHead.rows[0].cells].slice(1);
    const box = (head, k) => {
      const input = make("input", { type: "checkbox", checked: "" });
      input.addEventListener("change", () => [...table.rows].forEach((row) => { row.cells[k + 1].hidden = !input.checked; }));
      return make("label", {}, input, " " + head.textContent.replace(/\s+/g, " ").trim());
    };
    return make("details", { class: "choose" }, make("summary", {}, "Columns"), ...heads.map(box));
  };
  // Any column of numbers of the table of runs against any other.
  const scatter = (table, after) => {
    const heads = [...table.tHead.rows[0].cells];
    const rows = [...table.tBodies[0].rows];
    const title = (at) => heads[at].innerText.replace(/\s+/g, " ").trim().replace(/ ([^ ]+)$/, heads[at].querySelector("small") ? " ($1)" : " $1");
    const usable = heads.map((head, at) => at).filter((at) => heads[at].matches(".number") && rows.filter((row) => isFinite(numberIn(row.cells[at].textContent))).length > 1);
    const choice = (name, first) => {
      const select = make("select", { "aria-label": name }, ...usable.map((at) => make("option", { value: at }, title(at))));
      select.value = String(usable[Math.min(first, usable.length - 1)]);
      return select;
    };
    const box = make("details", { class: "choose" }, make("summary", {}, "Scatter"));
    if (usable.length < 2) return box;
    const [y, x] = [choice("Upright", 2), choice("Across", 0)];
    const place = make("div", { class: "panel" });
    const axisOf = (numbers) => {
      const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
      if (low > 0 && high > 10 * low) return { scale: 1, low: Math.log10(low) - 0.1, high: Math.log10(high) + 0.1 };
      const room = 0.06 * (high - low) || 1;
      return { scale: 0, low: low - room, high: high + room };
    };
    const drawn = async () => {
      const all = await runs(), indexOf = new Map(all.map((run, k) => [run.href, k]));
      const points = rows.filter((row) => !row.matches(".out"))
        .map((row) => ({ run: indexOf.get(row.querySelector("a").getAttribute("href")), x: numberIn(row.cells[x.value].textContent), y: numberIn(row.cells[y.value].textContent) }))
        .filter((point) => isFinite(point.x) && isFinite(point.y));
      const [ax, ay] = [axisOf(points.map((p) => p.x)), axisOf(points.map((p) => p.y))];
      const [left, top, right, bottom] = [660, 100, 3960, 2100];
      const to = (axis, value, from, upto) => from + ((positionOf(axis, value) - axis.low) / (axis.high - axis.low)) * (upto - from);
      const svg = document.createElementNS(SVG, "svg");
      for (const [key, value] of Object.entries({ viewBox: "0 0 4100 2560", class: "figure", "aria-label": `${title(y.value)} against ${title(x.value)}` })) svg.setAttribute(key, value);
      const panel = draw("g", { "data-f": [left, top, right, bottom].join(" ") }, svg);
      draw("g", { class: "axes", "data-x": [ax.scale, ax.low, ax.high].join(" "), "data-y": [ay.scale, ay.low, ay.high].join(" ") }, panel);
      const series = draw("g", { "data-s": "Runs", "data-r": points.map((p) => p.run).join(" ") }, panel);
      draw("path", { class: "dots", style: `marker:url(#${marker(0)})`, "stroke-width": 64, d: written([points.map((p) => [to(ax, p.x, left, right), to(ay, p.y, bottom, top)])]) }, series);
      draw("text", { class: "axis", x: (left + right) / 2, y: bottom + 360 }, panel).textContent = title(x.value);
      draw("text", { class: "axis up", x: -(top + bottom) / 2, y: 120 }, panel).textContent = title(y.value);
      place.replaceChildren(svg);
      const chart = new Chart(svg);
      chart.panels.forEach((own) => own.drawAxes());
    };
    [x, y].forEach((select) => select.addEventListener("change", drawn));
    box.append(y, " against ", x);
    after.after(place);
    box.addEventListener("toggle", () => { place.hidden = !box.open; if (box.open) drawn(); });
    return box;
  };
  const saveAll = () => {
    const main = document.querySelector("main");
    if (!main || charts.length < 2) return;
    const button = make("button", { type: "button", class: "tool" }, `Save all ${charts.length} figures as SVG`);
    button.addEventListener("click", () => charts.forEach((chart, k) => setTimeout(() => save(chart.svg.id + ".svg", "image/svg+xml", alone(chart.svg)), 250 * k)));
    main.append(make("p", { class: "tools" }, button));
  };

  // ---------------------------------------------------------------- one toolbox for all figures and tables of all pages
  // A pattern is what a run is found by, `air voltage_v=2.5`, or a regular expression between slashes; `!` before it means all
  // but these. What is of no run, as the line of a group, answers by its name and by the tags that stand in it.
  const answering = (text) => {
    const tests = text.split(",").map((part) => part.trim()).filter(Boolean).map((part) => {
      const not = part.startsWith("!"), own = part.slice(not ? 1 : 0).trim(), form = /^\/(.+)\/$/.exec(own);
      const expression = form && new RegExp(form[1], "i");
      const answers = form ? (run) => expression.test(run.text) : matcher(own);
      return (run) => answers(run) !== not;
    });
    return tests.length ? (run) => tests.some((test) => test(run)) : null;
  };
  // `S1 = first strip, S2 = second strip`: what is left of the sign is replaced where it stands as a word.
  const renaming = (text) => {
    const pairs = text.split(",").map((pair) => /^\s*(.+?)\s*=\s*(.*?)\s*$/.exec(pair)).filter(Boolean).map(([, from, to]) => {
      const form = /^\/(.+)\/$/.exec(from), letter = /[\p{L}\p{N}]/u;
      const plain = from.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
      const edge = (sign, sort) => (letter.test(sign) ? sort : "");
      const wanted = form ? form[1] : edge(from[0], "(?<![\\p{L}\\p{N}])") + plain + edge(from[from.length - 1], "(?![\\p{L}\\p{N}])");
      return [new RegExp(wanted, "gu"), to];
    });
    return (own) => pairs.reduce((so, [from, to]) => so.replace(from, to), own);
  };
  const toolbox = { mark: null, hide: null, rename: (text) => text, after: [], named: (name) => ({ text: name.toLowerCase(), tags: {} }), all: [] };
  // Hides and marks in these figures what it says.
  toolbox.paint = (of) => {
    const { mark, hide, named, all } = toolbox;
    for (const chart of of) {
      const seen = chart.panels.flatMap((panel) => panel.series).filter((s) => s.name);
      const lit = new Map();
      for (const series of seen) {
        const own = named(series.name), ofRuns = series.points.some((point) => all[point.run]);
        const says = (test, point) => !!test?.(all[point?.run] || own);
        for (const point of series.points) Object.assign(point, { off: ofRuns && says(hide, point), lit: ofRuns && says(mark, point) });
        series.boxed = ofRuns ? series.points.every((point) => point.off) : says(hide);
        series.display();
        lit.set(series, ofRuns ? (series.points.some((point) => point.lit) ? "points" : "") : says(mark) ? "all" : "");
      }
      // A figure in which nothing stands out stays as it is.
      const any = [...lit.values()].some(Boolean);
      for (const series of seen) series.element.classList.toggle("dimmed", any && lit.get(series) !== "all");
      chart.panels.forEach((panel) => panel.show(panel.view?.x || null));
    }
  };
  const toolboxes = () => {
    const heading = document.querySelector("main h1");
    if (!heading || !document.querySelector("header.site")) return;
    const WORDS = { mark: ["Highlight", "air voltage_v=2.5"], hide: ["Hide", "CNaf-1, /inert|vacuum/, !air"], rename: ["Rename", "CNaf-1 = strip 1"] };
    const status = make("p", { role: "status" });
    const fields = KEPT.map((key) => {
      const input = make("input", { type: "text", autocomplete: "off", spellcheck: "false", placeholder: WORDS[key][1] });
      input.value = state[key] || "";
      return [key, input];
    });
    let last = fields[0][1], waits;
    const texts = new WeakMap();
    const renamed = () => {
      const walker = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
      while (walker.nextNode()) {
        const node = walker.currentNode;
        if (node.parentElement.closest("code, .toolbox, select, datalist, title, desc")) continue;
        const own = texts.get(node)?.is === node.data ? texts.get(node).was : node.data, is = toolbox.rename(own);
        if (is !== node.data) node.data = is;
        if (is !== own) texts.set(node, { was: own, is });
      }
    };
    let touched = false;
    const apply = async () => {
      const given = fields.filter(([, input]) => input.value.trim());
      picker.firstElementChild.textContent = "Toolbox" + (given.length ? `: ${given.map(([key]) => WORDS[key][0].toLowerCase()).join(", ")}` : "");
      if (!given.length && !touched) return;
      touched = true;
      toolbox.all = await runs();
      const { keys, values } = window.ieapRuns || { keys: [], values: [] };
      const tagsOf = new Map();
      keys.forEach((key, k) => values[k].forEach((value) => tagsOf.set(value, { ...tagsOf.get(value), [key]: value })));
      toolbox.named = (name) => ({ text: name.toLowerCase(), tags: Object.assign({}, ...[name, ...name.split(/,?\s+/)].map((word) => tagsOf.get(word))) });
      status.textContent = "";
      for (const [key, input] of fields) {
        try {
          toolbox[key] = (key === "rename" ? renaming : answering)(input.value);
          input.removeAttribute("aria-invalid");
        } catch (error) {
          input.setAttribute("aria-invalid", "true");
          status.textContent = `${WORDS[key][0]}: not a pattern (${error.message})`;
        }
      }
      const { mark, hide, all, named } = toolbox, byHref = new Map(all.map((run) => [new URL(run.href, location.href).href, run]));
      const show = (element, run) => {
        element.classList.toggle("out", !!hide?.(run));
        element.classList.toggle("marked", !!mark?.(run));
      };
      const runOf = (link) => byHref.get(link.href.split("&")[0]);
      for (const row of document.querySelectorAll("main table:not(.matrix) > tbody > tr")) {
        const linked = [...row.querySelectorAll("a[href]")].map(runOf).find(Boolean);
        const words = () => [...row.cells].filter((cell) => cell.matches("th") || tagsOf.has(cell.textContent.trim())).map((cell) => cell.textContent.trim());
        show(row, linked || words().map(named).reduce((a, b) => ({ text: a.text + " " + b.text, tags: { ...a.tags, ...b.tags } }), { text: "", tags: {} }));
      }
      for (const link of document.querySelectorAll("main .matrix a.run, main .contact > a")) if (runOf(link)) show(link, runOf(link));
      toolbox.paint(charts);
      toolbox.after.forEach((act) => act());
      renamed();
      const count = all.filter((run) => hide?.(run)).length;
      if (count) status.textContent ||= `${count} of ${all.length} runs are hidden.`;
    };
    const changed = () => {
      remember(Object.fromEntries(fields.map(([key, input]) => [key, input.value.trim()])));
      clearTimeout(waits);
      waits = setTimeout(apply, 150);
    };
    for (const [, input] of fields) {
      input.addEventListener("input", changed);
      input.addEventListener("focus", () => { last = input; });
    }
    const clear = make("button", { type: "button", class: "tool" }, "Clear all");
    clear.addEventListener("click", () => { fields.forEach(([, input]) => { input.value = ""; }); changed(); });
    const picker = make("details", { class: "choose toolbox" }, make("summary", {}, "Toolbox"));
    const drawer = make("div", {},
      make("p", {}, "For all figures and tables of the report. Patterns as in “Find a run”, several with commas; ", make("code", {}, "!"), " before one: all but these; ", make("code", {}, "/…/"), ": a regular expression."),
      ...fields.map(([key, input]) => make("label", {}, WORDS[key][0], input)), status, clear);
    heading.before(picker);
    // Samples are put into the field that was used last.
    picker.addEventListener("toggle", async () => {
      if (drawer.isConnected) return;
      picker.append(drawer);
      const names = [...new Set((await runs()).map((run) => run.tags.sample).filter(Boolean))].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
      const chip = (name) => {
        const button = make("button", { type: "button", class: "key" }, name);
        button.addEventListener("click", () => {
          const own = last === fields[2][1] ? `${name} = ` : `sample=${name}`, now = last.value.split(",").map((part) => part.trim()).filter(Boolean);
          last.value = (now.includes(own) ? now.filter((part) => part !== own) : [...now, own]).join(", ");
          last.focus();
          changed();
        });
        return button;
      };
      status.before(make("div", { class: "names", role: "group", "aria-label": "Samples" }, ...names.map(chip)));
    });
    // What is chosen goes along to the next page of the report.
    document.addEventListener("click", (event) => {
      const link = event.target.closest?.("a[href]"), address = link?.getAttribute("href");
      const kept = KEPT.filter((key) => state[key]).map((key) => `&${key}=${encodeURIComponent(state[key])}`).join("");
      if (!kept || !/^[^:]*\.html(#|$)/.test(address)) return;
      const [page, place = ""] = address.split("#");
      link.setAttribute("href", `${page}#${place.split("&")[0]}${kept}`);
    }, true);
    apply();
  };

  // ---------------------------------------------------------------- served: the page follows the report
  const follow = () => {
    if (!/^https?:$/.test(location.protocol)) return;
    let known = null;
    const look = async () => {
      try {
        const answer = await fetch(root + ".made-from", { cache: "no-store" });
        if (!answer.ok) return;
        const now = await answer.text();
        if (known !== null && now !== known) {
          sessionStorage.setItem("at " + location.pathname, String(scrollY));
          return location.reload();
        }
        known = now;
      } catch { /* the server is away for a moment */ }
      setTimeout(look, 2000);
    };
    const at = sessionStorage.getItem("at " + location.pathname);
    if (at !== null) { sessionStorage.removeItem("at " + location.pathname); scrollTo(0, Number(at)); }
    look();
  };

  // ---------------------------------------------------------------- a strip that moves
  // Frames are `time|measured|simulated`, the last two path data in the drawing of the shapes. Nothing moves before it is
  // asked to, everything that moves can be stopped, and who wants no motion goes through the frames by hand.
  const films = () => {
    const LENGTH = 8000;
    for (const svg of document.querySelectorAll("svg[data-film]")) {
      const frames = svg.dataset.film.split(";").map((frame) => frame.split("|"));
      if (frames.length < 2) continue;
      const moving = draw("g", { class: "moving" }, svg);
      const simulated = draw("path", { class: "s k-2", "stroke-width": 18, "stroke-dasharray": "55 40" }, moving);
      const measured = draw("path", { class: "s k-text", "stroke-width": 32 }, moving);
      const slider = make("input", { type: "range", min: 0, max: frames.length - 1, value: 0, "aria-label": "Time since the step" });
      const time = make("output", { class: "time" }), play = make("button", { type: "button", class: "tool" }, "Play");
      const stills = make("button", { type: "button", class: "tool", hidden: "" }, "Show stills");
      let timer = null;
      const show = (at) => {
        const [when, now, fitted] = frames[at];
        measured.setAttribute("d", now);
        simulated.setAttribute("d", fitted);
        slider.value = at;
        slider.setAttribute("aria-valuetext", when);
        time.textContent = when;
        svg.classList.add("playing");
        stills.hidden = false;
      };
      const stop = () => { clearInterval(timer); timer = null; play.textContent = "Play"; };
      play.addEventListener("click", () => {
        if (timer !== null) return stop();
        let at = Number(slider.value) + 1 < frames.length ? Number(slider.value) : 0;
        show(at);
        play.textContent = "Pause";
        timer = setInterval(() => { if (++at < frames.length) show(at); else stop(); }, LENGTH / frames.length);
      });
      slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
      stills.addEventListener("click", () => { stop(); svg.classList.remove("playing"); time.textContent = ""; slider.value = 0; stills.hidden = true; play.focus(); });
      const calm = matchMedia("(prefers-reduced-motion: reduce)");
      const heed = () => { play.hidden = calm.matches; if (calm.matches) stop(); };
      calm.addEventListener("change", heed);
      heed();
      svg.after(make("div", { class: "tools film", role: "group", "aria-label": "The strip in motion" }, play, slider, time, stills));
    }
  };

  // Without a page only what reads numbers is there, for its test.
  if (typeof module !== "undefined") {
    module.exports = { valueAt, positionOf, parsed, heightAt };
    return;
  }
  // A link to a run of this page's group that has gone to another page since.
  const { place } = state;
  const moved = async () => {
    const run = (await runs()).find((run) => run.place === place);
    if (run) location.replace(run.href);
  };
  finder();
  document.querySelectorAll("main table").forEach(sortable);
  document.querySelectorAll("main svg.figure").forEach((svg) => new Chart(svg));
  legends();
  perVolt();
  films();
  byTags();
  document.querySelectorAll("main table").forEach(takeAlong);
  saveAll();
  toolboxes();
  const [zoomed, ...ends] = (state.zoom || "").split(":");
  charts.find((chart) => chart.svg.id === zoomed)?.zoom(ends.map(Number));
  // What was added above has moved the place that the address names; a place in what is folded is opened.
  if (place && document.getElementById(place)) {
    const there = document.getElementById(place);
    for (let folded = there.closest("details"); folded; folded = folded.parentElement.closest("details")) folded.open = true;
    there.scrollIntoView();
  }
  else if (place && document.querySelector(".of-run, h1.run-name")) moved();
  follow();
})();
