  function roundTicks(low, high, wanted) {
    const rough = (high - low) / wanted;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= rough * 0.999);
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) {
      ticks.push([k * step, inWords(k * step, step)]);
    }
    return ticks;
  }

  /* A number to read, as fine as a step. */
  function inWords(value, step) {
    const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const far = value !== 0 && (Math.abs(value) >= 1e5 || places > 5);
    const text = far ? value.toPrecision(4) : value.toFixed(Math.min(places, 20));
    return text.replaceAll("-", "−");
  }

  /* One square with lines: the outputs of a channel, or its errors. */
  class Plot {
    constructor(element) {
      this.element = element;
      this.errors = element.parentElement.classList.contains("errors");
      this.lines = [...element.querySelectorAll("path.line")];
      this.whole = this.lines.map((line) => line.getAttribute("d"));
      this.drawing = element.querySelector("svg.lines");
      this.ground = element.querySelector("svg.ground");
      this.marks = element.parentElement.querySelector(".yaxis");
      this.band = element.querySelector("rect.band");
      this.full = element.dataset.y.split(" ").map(Number);
      if (this.band) {
        const box = ["y", "height"].map((name) => Number(this.band.getAttribute(name)));
        const value = (y) => this.full[1] - (y / SIDE) * (this.full[1] - this.full[0]);
        this.shaded = [value(box[0] + box[1]), value(box[0])];
      }
      this.cursor = document.createElement("div");
      this.cursor.className = "cursor";
      this.cursor.hidden = true;
      element.append(this.cursor);
    }

    name(line) { return (this.errors ? "error " : "") + line.dataset.series; }

    /* Until the samples are unpacked, the lines of the whole picture are stretched. */
    stretch(left, width) {
      this.drawing.setAttribute("viewBox", `${left} 0 ${width} ${SIDE}`);
    }

    draw(samples, times, fit) {
      this.height(fit ? this.fitted(samples, times) : this.full);
      this.stretch(0, SIDE);
      const columns = Math.max(200, Math.round(this.element.clientWidth));
      this.lines.forEach((line) => {
        const series = samples.named(this.name(line));
        line.setAttribute("d", samples.path(series, times, this.shown, columns));
      });
    }

    restore() {
      this.height(this.full);
      this.stretch(0, SIDE);
      this.lines.forEach((line, k) => line.setAttribute("d", this.whole[k]));
    }

    fitted(samples, times) {
      const framed = this.lines.map((line) => this.name(line))
        .filter((name) => this.errors || name !== "before");
      const found = samples.range(framed, ...times);
      if (!found) return this.full;
      const air = 0.05 * (found[1] - found[0]);
      return [found[0] - air, found[1] + air];
    }

    height(shown) {
      if (this.shown && this.shown.every((end, k) => end === shown[k])) return;
      this.shown = shown;
      const [bottom, top] = shown;
      const share = (value) => (top - value) / (top - bottom);
      const ticks = roundTicks(bottom, top, 5);
      this.marks.replaceChildren(...ticks.map(([value, label]) => {
        const mark = document.createElement("span");
        mark.style.top = `${100 * share(value)}%`;
        mark.textContent = label;
        return mark;
      }));
      this.ground.querySelectorAll("line").forEach((line) => line.remove());
      for (const [value] of ticks) {
        const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
        const y = SIDE * share(value);
        for (const [key, at] of [["x1", 0], ["x2", SIDE], ["y1", y], ["y2", y]]) {
          line.setAttribute(key, at);
        }
        line.setAttribute("class", "grid");
        line.setAttribute("vector-effect", "non-scaling-stroke");
        this.ground.append(line);
      }
      if (this.band) {
        const [y, end] = [share(this.shaded[1]), share(this.shaded[0])];
        this.band.setAttribute("y", SIDE * y);
        this.band.setAttribute("height", SIDE * (end - y));
      }
    }
  }

  /* All charts of one recording: they share the stretch of time that is looked at. */
  class Recording {
    constructor(root) {
      this.root = root;
      this.channels = [...root.querySelectorAll("figure")].map((figure) => ({
        name: figure.dataset.channel,
        figure,
        plots: [...figure.querySelectorAll(".plot")].map((plot) => new Plot(plot)),
        script: figure.querySelector("script"),
        reading: figure.querySelector(".reading"),
        axis: figure.querySelector(".xaxis"),
        where: figure.querySelector(".where"),
        samples: null,
      }));
      this.plots = this.channels.flatMap((channel) => channel.plots);
      this.said = root.querySelector(".said");
      this.full = this.plots[0].element.dataset.x.split(" ").map(Number);
      [this.left, this.width, this.fit, this.drawn] = [0, SIDE, false, false];
      this.tools = root.querySelector(".tools");
      this.tools.hidden = false;
      this.buttons = {};
      for (const button of this.tools.querySelectorAll("button")) {
        this.buttons[button.dataset.do] = button;
        button.addEventListener("click", () => this.act(button.dataset.do));
      }
      this.plots.forEach((plot) => this.listen(plot));
      this.moved();
    }

    get times() {
      const time = (x) => this.full[0] + (x / SIDE) * (this.full[1] - this.full[0]);
      return [time(this.left), time(this.left + this.width)];
    }

    act(what, at = 0.5) {
      const { left, width } = this;
      const moves = {
        in: [left + (width / 2) * at, width / 2],
        out: [left - width * at, width * 2],
        left: [left - width / 4, width],
        right: [left + width / 4, width],
        all: [0, SIDE],
        fit: [left, width],
      };
      if (what === "fit" || what === "all") this.fit = what === "fit" && !this.fit;
      this.show(...moves[what]);
    }

    show(left, width) {
      const least = SIDE / Math.max(2000, this.channels[0].samples?.count ?? 0) * 8;
      this.width = Math.min(SIDE, Math.max(least, width));
      this.left = Math.min(SIDE - this.width, Math.max(0, left));
      this.moved();
      this.wanted ??= requestAnimationFrame(() => { this.wanted = null; this.draw(); });
      this.unpack();
      clearTimeout(this.saying);
      this.saying = setTimeout(() => { this.said.textContent = this.view(); }, 300);
    }

    view() {
      const [from, to] = this.times;
      const step = (to - from) / 100;
      const what = this.width >= SIDE ? "all of it, " : "";
      return `Showing ${what}${inWords(from, step)} to ${inWords(to, step)} s.`;
    }

    moved() {
      const [low, high] = this.times;
      const ticks = roundTicks(low, high, 6);
      for (const { axis, where } of this.channels) {
        axis.replaceChildren(...ticks.map(([value, label]) => {
          const mark = document.createElement("span");
          mark.style.left = `${(100 * (value - low)) / (high - low)}%`;
          mark.textContent = label;
          return mark;
        }));
        where.firstElementChild.style.left = `${this.left / 10}%`;
        where.firstElementChild.style.width = `${this.width / 10}%`;
        where.classList.toggle("part", this.width < SIDE);
      }
      this.buttons.fit.setAttribute("aria-pressed", String(this.fit));
      const [start, end] = [this.left <= 0, this.left + this.width >= SIDE];
      const blind = { left: start, right: end, out: start && end, all: start && end && !this.fit };
      for (const [name, off] of Object.entries(blind)) {
        this.buttons[name].setAttribute("aria-disabled", String(off));
      }
    }

    draw() {
      const whole = this.width >= SIDE && !this.fit;
      for (const { plots, samples } of this.channels) {
        for (const plot of plots) {
          if (whole) plot.restore();
          else if (samples) plot.draw(samples, this.times, this.fit);
          else plot.stretch(this.left, this.width);
        }
      }
      this.drawn = true;
    }

    /* Unpacks the samples when they are asked for first; where the browser cannot, the
       lines of the whole picture stay, stretched. */
    unpack() {
      if (!("DecompressionStream" in window)) return Promise.resolve();
      this.unpacked ??= Promise.all(this.channels.map(async (channel) => {
        channel.samples = await Samples.unpack(channel.script);
      })).then(() => this.draw());
      return this.unpacked;
    }

    async read(share) {
      this.reading = Math.min(1, Math.max(0, share));
      await this.unpack();
      const [from, to] = this.times;
      const time = from + this.reading * (to - from);
      const told = [];
      for (const { name, plots, samples, reading } of this.channels) {
        for (const { cursor } of plots) {
          cursor.hidden = false;
          cursor.style.left = `${100 * this.reading}%`;
        }
        if (!samples) continue;
        const k = samples.before(time);
        const words = plots[0].lines.map((line) => {
          const series = samples.named(line.dataset.series);
          const value = series.at(k);
          const text = Number.isNaN(value) ? "no value"
            : value.toPrecision(4).replaceAll("-", "−");
          return `${line.dataset.series} ${text}`;
        });
        reading.hidden = false;
        reading.textContent =
          `${inWords(samples.time(k), (to - from) / 1000)} s: ${words.join(", ")}`;
        told.push(`${name} at ${reading.textContent}`);
      }
      return told;
    }

    forget() {
      this.plots.forEach(({ cursor }) => { cursor.hidden = true; });
      this.channels.forEach(({ reading }) => { reading.hidden = true; });
    }

    listen({ element: plot }) {
      plot.tabIndex = 0;
      plot.setAttribute("role", "application");
      plot.setAttribute("aria-roledescription", "chart that can be zoomed");
      const place = (event) => {
        const box = plot.getBoundingClientRect();
        return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      };
      let start = null;
      const shade = document.createElement("div");
      shade.className = "selection";
      const stop = () => { start = null; shade.remove(); };
      plot.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        start = place(event);
        plot.setPointerCapture(event.pointerId);
      });
      plot.addEventListener("pointermove", (event) => {
        const here = place(event);
        this.read(here);
        if (start === null) return;
        shade.style.left = `${100 * Math.min(start, here)}%`;
        shade.style.width = `${100 * Math.abs(start - here)}%`;
        plot.append(shade);
      });
      plot.addEventListener("pointerup", (event) => {
        if (start === null) return;
        const [a, b] = [start, place(event)].sort((x, y) => x - y);
        stop();
        if (b - a > 0.02) this.show(this.left + a * this.width, (b - a) * this.width);
      });
      plot.addEventListener("pointercancel", stop);
      plot.addEventListener("pointerleave", () => { if (start === null) this.forget(); });
      plot.addEventListener("dblclick", () => this.act("all"));
      plot.addEventListener("wheel", (event) => {
        if (!event.ctrlKey) return; // plain turning scrolls the page
        event.preventDefault();
        this.act(event.deltaY < 0 ? "in" : "out", place(event));
      }, { passive: false });
      plot.addEventListener("keydown", (event) => {
        const acts = {
          "+": "in", "=": "in", "-": "out", 0: "all", f: "fit",
          ArrowLeft: "left", ArrowRight: "right",
        };
        if (!(event.key in acts) || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        const aside = { ArrowLeft: -0.01, ArrowRight: 0.01 }[event.key];
        if (event.shiftKey && aside) {
          this.read((this.reading ?? 0.5) + aside)
            .then((told) => { this.said.textContent = told.join(". "); });
        } else {
          this.act(acts[event.key]);
        }
      });
      plot.addEventListener("blur", () => this.forget());
    }
  }

  document.querySelectorAll("[data-recording]").forEach((root) => {
    root.recording = new Recording(root);
  });
