// Histograms with a brush: drag over the bars, or type the range.

const MARGIN = { left: 6, right: 6, top: 8, bottom: 18 };

export class Plot {
  // about: { title, unit, what, ticks, digits }; histogram: { low, width, counts }; onRange(range or null).
  constructor(host, about, histogram, onRange) {
    Object.assign(this, { about, histogram, onRange, range: null, marks: [], log: true });
    this.high = histogram.low + histogram.width * histogram.counts.length;
    this.total = histogram.counts.reduce((a, b) => a + b, 0);
    host.innerHTML = `<figure class="plot"><figcaption></figcaption><canvas tabindex="0" role="img"></canvas>
      <div class="range"><label>from <input type="number" class="from"></label><label>to <input type="number" class="to"></label>
      <button type="button" class="clear">all</button><output></output></div></figure>`;
    host.querySelector("figcaption").textContent = about.title;
    this.canvas = host.querySelector("canvas");
    this.from = host.querySelector(".from");
    this.to = host.querySelector(".to");
    this.output = host.querySelector("output");
    for (const input of [this.from, this.to]) {
      const placeholder = (input === this.from ? histogram.low : this.high).toFixed(about.digits);
      Object.assign(input, { min: histogram.low, max: this.high, step: about.step, placeholder });
      input.setAttribute("aria-label", `${about.title}, ${input === this.from ? "from" : "to"}`);
      input.addEventListener("change", () => this.typed());
    }
    host.querySelector(".clear").setAttribute("aria-label", `${about.title}: all`);
    host.querySelector(".clear").addEventListener("click", () => this.set(null));
    this.listen();
    this.show();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  typed() {
    const low = this.from.value === "" ? this.histogram.low : +this.from.value, high = this.to.value === "" ? this.high : +this.to.value;
    this.set(low < high ? [low, high] : null);
  }

  // Bars have their edges at whole bins, so brushes snap to them, and counts are exact.
  set(range) {
    const { low, width } = this.histogram;
    const snap = (x, round) => low + width * round((x - low) / width);
    if (range) {
      const digits = this.about.digits + 2;
      range = [Math.max(low, snap(range[0] + 1e-9, Math.floor)), Math.min(this.high, snap(range[1] - 1e-9, Math.ceil))].map((x) => +x.toFixed(digits));
      if (range[0] <= low && range[1] >= this.high) range = null;
    }
    this.range = range;
    this.show();
    this.draw();
    this.onRange(range);
  }

  show() {
    const { range, about } = this;
    this.from.value = range ? range[0].toFixed(about.digits) : "";
    this.to.value = range ? range[1].toFixed(about.digits) : "";
    const count = this.countIn(range).toLocaleString("en"), all = this.total.toLocaleString("en");
    this.output.textContent = range ? `${count} of ${all}` : `${all} ${about.what}`;
    this.canvas.setAttribute("aria-label", `Histogram: ${about.title}. ${this.output.textContent}.`);
  }

  countIn(range) {
    const { low, width, counts } = this.histogram;
    if (!range) return this.total;
    const first = Math.round((range[0] - low) / width), last = Math.round((range[1] - low) / width);
    return counts.slice(first, last).reduce((a, b) => a + b, 0);
  }

  listen() {
    const { canvas } = this;
    let start = null;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      start = this.valueAt(event.offsetX);
    });
    canvas.addEventListener("pointermove", (event) => {
      const value = this.valueAt(event.offsetX);
      if (start !== null && Math.abs(value - start) > 0.4 * this.histogram.width) this.set([Math.min(start, value), Math.max(start, value)]);
      this.hover = value;
      this.draw();
    });
    canvas.addEventListener("pointerup", (event) => {
      if (start !== null && Math.abs(this.valueAt(event.offsetX) - start) <= 0.4 * this.histogram.width) this.set(null);
      start = null;
    });
    canvas.addEventListener("pointercancel", () => (start = null));
    canvas.addEventListener("pointerleave", () => {
      this.hover = null;
      this.draw();
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  // Arrows move the brush by a bin, with Shift its upper end; Escape takes it away.
  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === "Escape") this.set(null);
    if (!step) return;
    event.preventDefault();
    const { low, width, counts } = this.histogram, move = step * width;
    if (!this.range) {
      const first = counts.findIndex((n) => n > 0), last = counts.findLastIndex((n) => n > 0);
      const at = step > 0 ? first : last - 4;
      this.set([low + at * width, low + (at + 5) * width]);
    } else {
      const [from, to] = this.range;
      this.set(event.shiftKey ? [from, Math.max(from + width, to + move)] : [from + move, to + move]);
    }
  }

  valueAt(x) {
    const inner = this.canvas.clientWidth - MARGIN.left - MARGIN.right;
    return this.histogram.low + (Math.max(0, Math.min(inner, x - MARGIN.left)) / inner) * (this.high - this.histogram.low);
  }

  draw() {
    const { canvas, histogram } = this, { clientWidth: width, clientHeight: height } = canvas, ratio = Math.min(2, window.devicePixelRatio);
    if (width === 0) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext("2d"), style = getComputedStyle(canvas), colour = (name) => style.getPropertyValue(name);
    pen.scale(ratio, ratio);
    const inner = width - MARGIN.left - MARGIN.right, tall = height - MARGIN.top - MARGIN.bottom, floor = MARGIN.top + tall;
    const place = (value) => MARGIN.left + ((value - histogram.low) / (this.high - histogram.low)) * inner;
    const most = Math.max(1, ...histogram.counts), share = (n) => (n === 0 ? 0 : this.log ? 0.06 + (0.94 * Math.log(n)) / Math.log(Math.max(2, most)) : n / most);
    if (this.range) {
      pen.fillStyle = colour("--brush");
      pen.fillRect(place(this.range[0]), MARGIN.top - 4, place(this.range[1]) - place(this.range[0]), tall + 4);
    }
    histogram.counts.forEach((count, i) => {
      const from = histogram.low + i * histogram.width, middle = from + histogram.width / 2;
      const inside = !this.range || (middle > this.range[0] && middle < this.range[1]);
      const bar = Math.max(count > 0 ? 1 : 0, share(count) * tall), left = place(from);
      pen.fillStyle = colour(inside ? "--bar" : "--bar-off");
      pen.fillRect(left, floor - bar, Math.max(1, place(from + histogram.width) - left - 0.6), bar);
    });
    pen.fillStyle = colour("--pick");
    for (const value of this.marks) pen.fillRect(place(Math.min(value, this.high)) - 1, MARGIN.top - 4, 2, tall + 8);
    pen.strokeStyle = colour("--line");
    pen.beginPath();
    pen.moveTo(MARGIN.left, floor + 0.5);
    pen.lineTo(width - MARGIN.right, floor + 0.5);
    pen.stroke();
    pen.fillStyle = colour("--soft");
    pen.font = "11px system-ui, sans-serif";
    this.about.ticks.forEach((tick, i, all) => {
      pen.textAlign = i === 0 ? "left" : i === all.length - 1 ? "right" : "center";
      pen.fillText(tick + (i === all.length - 1 ? this.about.end ?? this.about.unit : this.about.unit), place(tick) + (i === 0 ? -MARGIN.left + 4 : i === all.length - 1 ? MARGIN.right - 2 : 0), height - 4);
    });
    if (this.hover != null) this.drawHover(pen, colour, width);
  }

  drawHover(pen, colour, width) {
    const { low, width: bin, counts } = this.histogram, i = Math.min(counts.length - 1, Math.floor((this.hover - low) / bin)), from = low + i * bin;
    const { digits, unit } = this.about;
    const text = `${from.toFixed(digits)} to ${(from + bin).toFixed(digits)}${unit}: ${counts[i].toLocaleString("en")}`;
    pen.textAlign = this.hover > (low + this.high) / 2 ? "left" : "right";
    pen.fillStyle = colour("--ink");
    pen.fillText(text, pen.textAlign === "left" ? MARGIN.left : width - MARGIN.right, MARGIN.top + 6);
  }
}
