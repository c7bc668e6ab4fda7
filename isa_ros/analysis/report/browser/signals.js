'use strict';
// Reads the signals of the page (isa_ros/analysis/report/encoding.py) and thins them for drawing.

const LEVELS = 65533, GAP = 65535;
let stored = null;                      // bytes of all signals, once they are inflated
const decoded = new Map();              // Float32Array by offset
const gridTimes = new Map();            // Float64Array by index, of times that are not even

async function inflate(text) {
  const raw = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text)
    : Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([raw]).stream().pipeThrough(new DecompressionStream('deflate'));
  stored = new Uint8Array(await new Response(stream).arrayBuffer());
}

function unevenTimes(grid, index) {
  if (!gridTimes.has(index)) {
    const n = grid.n, times = new Float64Array(n), o = grid.offset;
    const scale = (grid.high - grid.t0) / (2 ** 32 - 1);
    for (let i = 0, sum = 0; i < n; i++) {
      sum += stored[o + i] + stored[o + n + i] * 2 ** 8 + stored[o + 2 * n + i] * 2 ** 16
        + stored[o + 3 * n + i] * 2 ** 24;
      times[i] = grid.t0 + sum * scale;
    }
    gridTimes.set(index, times);
  }
  return gridTimes.get(index);
}

// {t(i), at(t), n} of a grid: time of a sample, and the sample nearest to a time.
function gridOf(grids, index) {
  const grid = grids[index], n = grid.n;
  if (grid.offset === undefined) {
    return { n, t: i => grid.t0 + i * grid.step,
             at: t => Math.min(n - 1, Math.max(0, Math.round((t - grid.t0) / grid.step))) };
  }
  const times = unevenTimes(grid, index);
  return { n, t: i => times[i], at: t => {
    let low = 0, high = n - 1;
    while (low < high) { const k = low + high >> 1; if (times[k] < t) low = k + 1; else high = k; }
    return low && t - times[low - 1] < times[low] - t ? low - 1 : low;
  } };
}

// In the unit of the panel: signal is {offset, low, high}.
function valuesOf(signal, n) {
  if (!decoded.has(signal.offset)) {
    const out = new Float32Array(n), o = signal.offset;
    const step = signal.high / LEVELS - signal.low / LEVELS;
    for (let i = 0, v = 0, d = 0; i < n; i++) {
      const z = stored[o + i] | stored[o + n + i] << 8;
      d = d + ((z >>> 1) ^ -(z & 1)) & 0xffff;
      v = v + d & 0xffff;
      out[i] = v === GAP ? NaN : signal.low + v * step;
    }
    decoded.set(signal.offset, out);
  }
  return decoded.get(signal.offset);
}

// Times and values from t0 to t1: all of few samples; of many, least and greatest in each of
// `pixels` parts, in the order they came, so that no peak is lost. A gap stays one.
function thinned(grid, values, t0, t1, pixels) {
  const from = Math.max(0, grid.at(t0) - 1), to = Math.min(grid.n, grid.at(t1) + 2);
  const size = Math.ceil((to - from) / pixels), x = [], y = [];
  const put = i => { x.push(grid.t(i)); y.push(Number.isNaN(values[i]) ? null : values[i]); };
  if (size <= 2) {
    for (let i = from; i < to; i++) put(i);
    return [x, y];
  }
  for (let begin = from; begin < to; begin += size) {
    const end = Math.min(begin + size, to);
    let low = begin, high = begin, gap = -1;
    for (let i = begin; i < end; i++) {
      const v = values[i];
      if (Number.isNaN(v)) gap = i;
      else if (!(v >= values[low])) low = i;
      else if (!(v <= values[high])) high = i;
    }
    if (Number.isNaN(values[high])) high = low;
    const kept = [low, high, ...(gap < 0 ? [] : [gap])].sort((a, b) => a - b);
    kept.forEach((i, k) => { if (i !== kept[k - 1]) put(i); });
  }
  return [x, y];
}
