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
        down.fill(65535);
        for (let k = 0; k < lower.length; k += 1) {
          if (upper[k] === GAP) continue;
          const n = Math.floor(k / FACTOR);
          if (lower[k] < down[n]) down[n] = lower[k];
          if (upper[k] > up[n]) up[n] = upper[k];
        }
        this.levels.push({ least: down, greatest: up });
        [lower, upper] = [down, up];
      }
    }

    value(code) { return code === GAP ? NaN : this.low + (code - 1) * this.step; }

    at(index) { return this.value(this.levels[0].greatest[index]); }

    /* The least and the greatest code from one sample to another: at each level what
       does not fill a block of the next one, from both ends. */
    between(first, end) {
      const found = [65535, GAP];
      for (let n = 0; first < end; n += 1) {
        const [inner, outer] = [Math.ceil(first / FACTOR), Math.floor(end / FACTOR)];
        if (n + 1 === this.levels.length || inner >= outer) {
          widen(found, this.levels[n], first, end);
          break;
        }
        widen(found, this.levels[n], first, inner * FACTOR);
        widen(found, this.levels[n], outer * FACTOR, end);
        [first, end] = [inner, outer];
      }
      return found[1] === GAP ? [GAP, GAP] : found;
    }
  }

  function widen(found, { least, greatest }, from, to) {
    for (let k = from; k < to; k += 1) {
      if (greatest[k] === GAP) continue;
      if (least[k] < found[0]) found[0] = least[k];
      if (greatest[k] > found[1]) found[1] = greatest[k];
    }
  }

  /* All series of one output of one recording, and its clock. */
  class Samples {
    static async unpack(element) {
      const text = atob(element.textContent);
      const packed = new Uint8Array(text.length);
      for (let k = 0; k < text.length; k += 1) packed[k] = text.charCodeAt(k);
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
        const planes = Array.from({ length: width }, (_, b) =>
          bytes.subarray(at + b * this.count, at + (b + 1) * this.count));
        const codes = new Codes(this.count);
        const mask = width === 2 ? 0xffff : 0xffffffff;
        const [b0, b1, b2, b3] = planes;
        for (let k = 0, sum = 0; k < this.count; k += 1) {
          sum += b0[k] | (b1[k] << 8);
          if (width === 4) sum += (b2[k] << 16) | (b3[k] << 24);
          sum &= mask;
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
      const [a, b] = [one, other].map((series) => series.levels[0].greatest);
      const offset = (one.low + other.low - one.step - other.step - low) / step + 1;
      const [p, q] = [one.step / step, other.step / step];
      for (let k = 0; k < this.count; k += 1) {
        if (a[k] === GAP || b[k] === GAP) continue;
        const level = Math.round(offset + p * a[k] + q * b[k]);
        codes[k] = level < 1 ? 1 : level > 65535 ? 65535 : level;
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
      const tenth = (place) => Math.round(place * 10) / 10;
      const x = (k) => tenth(((this.time(k) - from) / (to - from)) * SIDE);
      const y = (code) => {
        const place = ((top - series.value(code)) / (top - bottom)) * SIDE;
        return tenth(Math.min(3 * SIDE, Math.max(-2 * SIDE, place)));
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
