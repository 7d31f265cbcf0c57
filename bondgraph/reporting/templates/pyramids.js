  const SIDE = 1000;
  const GAP = 0;
  const FACTOR = 4;

  /* One series in 16-bit codes (0 is a gap), with its least and greatest codes over 4,
     16, 64 ... samples, so that any stretch of it is drawn by looking at few numbers. */
  class Series {
    constructor({ low, step }, least, greatest) {
      this.low = low;
      this.step = step;
      this.levels = [{ least, greatest }];
      let [lower, upper] = [least, greatest];
      while (lower.length > 4 * FACTOR) {
        const count = Math.ceil(lower.length / FACTOR);
        const [down, up] = [new Uint16Array(count), new Uint16Array(count)];
        for (let k = 0; k < count; k += 1) {
          [down[k], up[k]] = extremes(lower, upper, FACTOR * k, FACTOR * (k + 1));
        }
        this.levels.push({ least: down, greatest: up });
        [lower, upper] = [down, up];
      }
    }

    value(code) { return code === GAP ? NaN : this.low + (code - 1) * this.step; }

    at(index) { return this.value(this.levels[0].greatest[index]); }

    /* The least and the greatest code from one sample to another. */
    between(first, end) {
      let level = 0;
      let width = 1;
      while (level + 1 < this.levels.length && end - first >= 4 * FACTOR * width) {
        level += 1;
        width *= FACTOR;
      }
      const { least, greatest } = this.levels[level];
      const inner = [Math.ceil(first / width), Math.floor(end / width)];
      let found = extremes(least, greatest, inner[0], inner[1]);
      if (level > 0) {
        const { least: l, greatest: g } = this.levels[0];
        found = joined(found, extremes(l, g, first, Math.min(inner[0] * width, end)));
        found = joined(found, extremes(l, g, Math.max(inner[1] * width, first), end));
      }
      return found;
    }
  }

  function extremes(least, greatest, first, end) {
    let low = 65535;
    let high = GAP;
    for (let k = first; k < Math.min(end, greatest.length); k += 1) {
      if (greatest[k] === GAP) continue;
      if (least[k] < low) low = least[k];
      if (greatest[k] > high) high = greatest[k];
    }
    return high === GAP ? [GAP, GAP] : [low, high];
  }

  function joined(one, other) {
    if (one[1] === GAP) return other;
    if (other[1] === GAP) return one;
    return [Math.min(one[0], other[0]), Math.max(one[1], other[1])];
  }

  /* All series of one output of one recording, and its clock. */
  class Samples {
    static async unpack(element) {
      const packed = Uint8Array.from(atob(element.textContent), (c) => c.charCodeAt(0));
      const stream = new Blob([packed]).stream()
        .pipeThrough(new DecompressionStream("deflate"));
      const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
      return new Samples(JSON.parse(element.dataset.header), bytes);
    }

    constructor(header, bytes) {
      this.header = header;
      this.count = header.count;
      this.series = new Map();
      let at = 0;
      const next = (width, Codes) => {
        const codes = new Codes(this.count);
        for (let k = 0, sum = 0; k < this.count; k += 1) {
          for (let b = 0; b < width; b += 1) {
            sum += bytes[at + b * this.count + k] * 2 ** (8 * b);
          }
          sum %= 2 ** (8 * width);
          codes[k] = sum;
        }
        at += width * this.count;
        return codes;
      };
      this.clock = header.step === null ? next(4, Uint32Array) : null;
      for (const one of header.series) {
        if (one.plus === null) {
          const least = next(2, Uint16Array);
          const greatest = header.every > 1 ? next(2, Uint16Array) : least;
          this.series.set(one.name, new Series(one, least, greatest));
        } else {
          const sum = this.sum(one, this.series.get("measured"), this.series.get(one.plus));
          this.series.set(one.name, new Series(one, sum, sum));
        }
      }
    }

    sum({ low, step }, one, other) {
      const codes = new Uint16Array(this.count);
      for (let k = 0; k < this.count; k += 1) {
        const value = one.at(k) + other.at(k);
        const level = Math.round((value - low) / step) + 1;
        codes[k] = Number.isNaN(value) ? GAP : Math.min(65535, Math.max(1, level));
      }
      return codes;
    }

    named(name) {
      return this.series.get(name);
    }

    time(index) {
      const { start, end, step } = this.header;
      if (step !== null) return start + index * step;
      return start + (this.clock[index] / (2 ** 32 - 1)) * (end - start);
    }

    /* The last sample that is not after a time. */
    before(time) {
      let [low, high] = [0, this.count - 1];
      while (low < high) {
        const middle = Math.ceil((low + high) / 2);
        if (this.time(middle) <= time) low = middle; else high = middle - 1;
      }
      return low;
    }

    /* The first sample to draw and the first not to, one more at each side. */
    inside(from, to) {
      return [
        Math.max(0, this.before(from) - 1), Math.min(this.count, this.before(to) + 3),
      ];
    }

    /* A line as SVG path in a square of 1000: every sample, or, where they are denser
       than the columns of the picture, the least and greatest of each column. */
    path(series, [from, to], [bottom, top], columns) {
      const [first, end] = this.inside(from, to);
      const x = (k) => (((this.time(k) - from) / (to - from)) * SIDE).toFixed(1);
      const y = (code) => {
        const place = ((top - series.value(code)) / (top - bottom)) * SIDE;
        return Math.min(3 * SIDE, Math.max(-2 * SIDE, place)).toFixed(1);
      };
      const parts = [];
      let pen = "M";
      const put = (k, low, high) => {
        if (high === GAP) { pen = "M"; return; }
        parts.push(`${pen}${x(k)} ${y(low)}`);
        if (high !== low) parts.push(`L${x(k)} ${y(high)}`);
        pen = "L";
      };
      if (end - first <= 2 * columns) {
        const { least, greatest } = series.levels[0];
        for (let k = first; k < end; k += 1) put(k, least[k], greatest[k]);
      } else {
        const width = (end - first) / columns;
        for (let c = 0; c < columns; c += 1) {
          const [k, after] = [c, c + 1].map((n) => Math.floor(first + n * width));
          put(k, ...series.between(k, after));
        }
      }
      return parts.join("");
    }

    /* The least and the greatest value of some series in a stretch of time. */
    range(names, from, to) {
      const [first, end] = this.inside(from, to);
      let [low, high] = [Infinity, -Infinity];
      for (const name of names) {
        const series = this.named(name);
        const [least, greatest] = series.between(first, end);
        if (greatest === GAP) continue;
        low = Math.min(low, series.value(least));
        high = Math.max(high, series.value(greatest));
      }
      return low < high ? [low, high] : null;
    }
  }
