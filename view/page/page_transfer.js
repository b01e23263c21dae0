// SPDX-License-Identifier: Apache-2.0
// Transfer functions: colour and opacity, each linear between knots, and their integrals over the value as tables.

const kCells = 4096, kTableWidth = 64;

// The value at v of knots [v, …], linear between them; of two knots at the same value the later one counts from there on.
function between(knots, v, channel) {
  if (v < knots[0][0]) return knots[0][channel];
  let low = 0, high = knots.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (knots[middle][0] <= v) low = middle;
    else high = middle;
  }
  if (high === knots.length) return knots[low][channel];
  const part = (v - knots[low][0]) / (knots[high][0] - knots[low][0]);
  return knots[low][channel] + part * (knots[high][channel] - knots[low][channel]);
}

function colorAt(transfer, v) { return [1, 2, 3].map((c) => between(transfer.color, v, c)); }
function alphaAt(transfer, v) { return between(transfer.opacity, v, 1); }

// How far along a range a value is, 0 to 1, by a scale: linear, of logarithms, or of these on both sides of 0, linear within a
// hundredth of the larger end. And the value that is so far along.
function scaleOf(kind, [a, b]) {
  const near = Math.max(Math.abs(a), Math.abs(b)) / 100;
  const to = kind === 'log' ? Math.log : kind === 'symlog' ? (v) => Math.sign(v) * Math.log1p(Math.abs(v) / near) : (v) => v;
  const from = kind === 'log' ? Math.exp : kind === 'symlog' ? (x) => Math.sign(x) * near * Math.expm1(Math.abs(x)) : (x) => x;
  const low = to(a), high = to(b);
  return (t) => t <= 0 ? a : t >= 1 ? b : from(low + t * (high - low));
}

// Knots of colours over a range, from those over [0,1]. bands: as many colours, the first and the last those of the ends; 0: no
// bands. tips: the colours below and above the range, or null
function spreadColors(scale, range, kind, bands, tips) {
  const valueAt = scaleOf(kind, range), knots = [], colors = { color: scale };
  if (bands > 0) {
    for (let i = 0; i < bands; ++i) {
      const rgb = colorAt(colors, bands > 1 ? i / (bands - 1) : 0.5);
      knots.push([valueAt(i / bands), ...rgb], [valueAt((i + 1) / bands), ...rgb]);
    }
  } else if (kind === 'linear') {
    for (const [t, ...rgb] of scale) knots.push([valueAt(t), ...rgb]);
  } else {
    const places = [...new Set([...scale.map((knot) => knot[0]), ...Array.from({ length: 65 }, (_, i) => i / 64)])].sort((a, b) => a - b);
    for (const t of places) knots.push([valueAt(t), ...colorAt(colors, t)]);
  }
  if (tips.below) knots.unshift([range[0], ...tips.below]);
  if (tips.above) knots.push([range[1], ...tips.above]);
  return knots;
}

// The colours that a function has below and above its range, where they jump at its ends: knots at one value, which the command
// moves a billionth of the range apart.
function tipsOf(color) {
  const near = 2e-9 * (color.at(-1)[0] - color[0][0]);
  const tip = (end, inner) => inner && Math.abs(end[0] - inner[0]) <= near ? end.slice(1) : null;
  return { below: tip(color[0], color[1]), above: tip(color.at(-1), color.at(-2)) };
}

// Whether all values have one colour.
function isPlain(transfer) {
  return transfer.color.every((knot) => [1, 2, 3].every((c) => knot[c] === transfer.color[0][c]));
}

// Prefix integrals of extinction and emission, as in lib/look/light: rows for what is below and above the cells at the ends. Within a
// cell the integral from its lower end to the part s is s · (mean − (1 − s) · bend). unit: of the opacities
function makeTable(transfer, unit) {
  const ends = [...transfer.color, ...transfer.opacity].map((knot) => knot[0]);
  const min = Math.min(...ends), max = Math.max(...ends) > min ? Math.max(...ends) : min + 1, width = (max - min) / kCells;
  const knots = [...new Set(ends)].sort((a, b) => a - b);
  const rows = kTableWidth * Math.ceil((kCells + 2) / kTableWidth);
  const table = { min, max, prefix: new Float32Array(4 * rows), mean: new Float32Array(4 * rows), bend: new Float32Array(4 * rows),
    colors: new Float32Array(4 * rows), rows: rows / kTableWidth, opaque: 0 };
  const light = (v) => {
    const tau = -Math.log1p(-Math.min(alphaAt(transfer, v), 1 - 1e-6)) / unit, rgb = colorAt(transfer, v);
    table.opaque = Math.max(table.opaque, tau);
    return [tau, tau * rgb[0], tau * rgb[1], tau * rgb[2]];
  };
  const places = [-Math.sqrt(0.6), 0, Math.sqrt(0.6)], weights = [5 / 18, 8 / 18, 5 / 18];  // of Gauss
  const sum = [0, 0, 0, 0];
  let next = 0;
  for (let row = 0; row < kCells + 2; ++row) {
    const low = min + (row - 1) * width, high = low + width, inside = row > 0 && row <= kCells;
    const mean = [0, 0, 0, 0];
    const first = light(inside ? low + 1e-9 * width : row === 0 ? min - width : max + width);
    const last = inside ? light(high - 1e-9 * width) : first;
    if (!inside) {
      mean.splice(0, 4, ...first);
    } else {
      let from = low;
      while (from < high) {
        while (next < knots.length && knots[next] <= from + 1e-12 * width) ++next;
        const to = Math.min(high, next < knots.length ? knots[next] : high), half = (to - from) / 2;
        places.forEach((place, k) => {
          const at = light(from + half + half * place), share = weights[k] * (to - from) / width;
          for (let c = 0; c < 4; ++c) mean[c] += share * at[c];
        });
        from = to;
      }
    }
    const color = colorAt(transfer, row === 0 ? min - width : low);
    for (let c = 0; c < 4; ++c) {
      const at = 4 * row + c;
      table.prefix[at] = row === 0 ? 0 : sum[c];
      table.mean[at] = mean[c];
      table.bend[at] = inside ? (last[c] - first[c]) / 2 : 0;
      if (c < 3) table.colors[at] = color[c];
      if (inside) sum[c] += mean[c];
    }
  }
  return table;
}

function srgbOfLinear(l) { return l <= 0.0031308 ? l * 12.92 : 1.055 * Math.pow(l, 1 / 2.4) - 0.055; }
function linearOfSrgb(s) { return s <= 0.04045 ? s / 12.92 : Math.pow((s + 0.055) / 1.055, 2.4); }
function cssColor(rgb) {
  return 'rgb(' + rgb.map((l) => Math.round(255 * srgbOfLinear(Math.min(1, Math.max(0, l))))).join(',') + ')';
}

// Round values for an axis, at most `most`, with as many digits as they need.
function roundTicks(min, max, most) {
  const range = max - min || 1, power = Math.pow(10, Math.floor(Math.log10(range / most)));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => range / s <= most), ticks = [];
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(min / step - 1e-9); k * step <= max + 1e-9 * step; ++k) {
    const v = k * step, large = Math.abs(v) >= 1e5 || (digits > 4 && v !== 0);
    ticks.push([v, large ? String(Number(v.toPrecision(4))) : v.toFixed(digits)]);
  }
  return ticks;
}
// The same with the values at the ends; round ones that are nearer to an end than a part of the axis are left out.
function ticksWithEnds(min, max, most, apart) {
  const far = apart * (max - min), inner = roundTicks(min, max, most).filter(([v]) => v - min > far && max - v > far);
  return [[min, shortNumber(min)], ...inner, [max, shortNumber(max)]];
}
function shortNumber(v) { return String(Number(v.toPrecision(5))); }
