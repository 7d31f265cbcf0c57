"use strict";
/* The page is complete without this script. It adds zooming along time, which all
   charts of one recording share, and copying of the model. */
(() => {
  const SIDE = 1000;

  function roundTicks(low, high, wanted) {
    const rough = (high - low) / wanted;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= rough * 0.999);
    const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) {
      ticks.push([k * step, (k * step).toFixed(places).replace("-", "−")]);
    }
    return ticks;
  }

  class Recording {
    constructor(root) {
      this.root = root;
      this.plots = [...root.querySelectorAll(".plot")];
      this.button = root.querySelector("button.reset");
      this.full = this.plots[0].dataset.range.split(" ").map(Number);
      this.button.addEventListener("click", () => this.show(0, SIDE));
      this.plots.forEach((plot) => this.listen(plot));
      this.show(0, SIDE);
    }

    show(left, width) {
      this.width = Math.min(SIDE, Math.max(SIDE / 2000, width));
      this.left = Math.min(SIDE - this.width, Math.max(0, left));
      const time = (x) => this.full[0] + (x / SIDE) * (this.full[1] - this.full[0]);
      const [low, high] = [time(this.left), time(this.left + this.width)];
      for (const plot of this.plots) {
        plot.querySelector("svg.lines")
          .setAttribute("viewBox", `${this.left} 0 ${this.width} ${SIDE}`);
        const axis = plot.parentElement.querySelector(".xaxis");
        if (axis) {
          axis.replaceChildren(...roundTicks(low, high, 6).map(([value, label]) => {
            const mark = document.createElement("span");
            mark.style.left = `${(100 * (value - low)) / (high - low)}%`;
            mark.textContent = label;
            return mark;
          }));
        }
      }
      this.button.hidden = this.width >= SIDE;
    }

    listen(plot) {
      const place = (event) => {
        const box = plot.getBoundingClientRect();
        return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      };
      let start = null;
      const shade = document.createElement("div");
      shade.className = "selection";
      plot.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        start = place(event);
        plot.setPointerCapture(event.pointerId);
      });
      plot.addEventListener("pointermove", (event) => {
        if (start === null) return;
        const here = place(event);
        shade.style.left = `${100 * Math.min(start, here)}%`;
        shade.style.width = `${100 * Math.abs(start - here)}%`;
        plot.append(shade);
      });
      plot.addEventListener("pointerup", (event) => {
        if (start === null) return;
        const [a, b] = [start, place(event)].sort((x, y) => x - y);
        start = null;
        shade.remove();
        if (b - a > 0.02) this.show(this.left + a * this.width, (b - a) * this.width);
      });
      plot.addEventListener("pointercancel", () => { start = null; shade.remove(); });
      plot.addEventListener("dblclick", () => this.show(0, SIDE));
      plot.addEventListener("keydown", (event) => {
        const { left, width } = this;
        const moves = {
          "+": [left + width / 4, width / 2], "=": [left + width / 4, width / 2],
          "-": [left - width / 2, width * 2], "0": [0, SIDE],
          ArrowLeft: [left - width / 4, width], ArrowRight: [left + width / 4, width],
        };
        if (!(event.key in moves) || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        this.show(...moves[event.key]);
      });
    }
  }

  document.querySelectorAll("[data-recording]").forEach((root) => new Recording(root));

  document.querySelectorAll("button[data-copy]").forEach((button) => {
    button.hidden = false;
    button.addEventListener("click", async () => {
      const source = document.getElementById(button.dataset.copy);
      const said = button.parentElement.querySelector("[role=status]");
      try {
        await navigator.clipboard.writeText(source.textContent);
        said.textContent = "Copied.";
      } catch {
        getSelection().selectAllChildren(source);
        said.textContent = "Selected: press Ctrl+C or ⌘C.";
      }
    });
  });
})();
