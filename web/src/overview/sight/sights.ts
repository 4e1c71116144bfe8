// What the pixels of a picture in three dimensions show, as the server sends it (server/SERVING.md, "What is seen, as
// numbers"). Pure.
type Labels = Uint8Array | Uint16Array | Uint32Array;

// Light on a surface of colour c, on squares of colours: c * c * own / OWN + added / ADDED.
export const OWN = 160;
export const ADDED = 1275;

interface Lit {
  readonly label: Labels; // 0: nothing; otherwise 1 + the label
  readonly own: Uint8Array;
  readonly added: Uint8Array;
  readonly facing: Uint8Array; // the cosine of the angle between the normal and the line of sight, times 255
}

export interface Sights extends Lit {
  readonly width: number;
  readonly height: number;
  readonly step: number; // by what share distances may be wrong, because they are rounded; without perspective, by what length
  readonly far: Float32Array; // the distance from the plane of the eye, 0 where nothing is seen; rows from the top
  // Pixels of which the middle is too little to know: four points of each.
  readonly edges: Lit & { readonly at: Uint32Array };
}

// Adds up what was written as differences along a row.
function summed(steps: Uint8Array, width: number): Uint8Array {
  const out = new Uint8Array(steps.length);
  for (let i = 0, sum = 0; i < steps.length; ++i) {
    if (i % width === 0) sum = 0;
    sum = (sum + steps[i]!) & 255;
    out[i] = sum;
  }
  return out;
}

const NEAREST = 1e-38; // above 0 in single precision

// `scale`: by which distances are multiplied. Throws when these are not such bytes.
export function decode_sights(buffer: ArrayBuffer, scale: number, perspective = true): Sights {
  const view = new DataView(buffer);
  if (buffer.byteLength < 40 || view.getUint32(0, true) !== 0x31534354) throw new Error("what is seen: expected bytes that begin with TCS1");
  const [width, height, count] = [4, 8, 12].map((at) => view.getUint32(at, true)) as [number, number, number];
  const [nearest, farthest] = [view.getFloat64(16, true) * scale, view.getFloat64(24, true) * scale];
  const wide = view.getUint32(32, true);
  const n = width * height;
  const expected = 40 + n * (wide + 5) + Math.ceil(n / 8) + 4 * count * (wide + 3);
  if (buffer.byteLength !== expected) throw new Error(`what is seen: expected ${expected} bytes, found ${buffer.byteLength}`);
  let at = 40;
  const bytes = (length: number) => new Uint8Array(buffer, (at += length) - length, length);
  const labels = (length: number): Labels => {
    if (wide === 1) return bytes(length);
    const copy = bytes(wide * length).slice().buffer;
    return wide === 2 ? new Uint16Array(copy) : new Uint32Array(copy);
  };
  const label = labels(n);
  const [low, high] = [bytes(n), bytes(n)];
  const far = new Float32Array(n);
  const stretch = farthest > nearest ? (perspective ? Math.log(farthest / nearest) : farthest - nearest) / 65534 : 0;
  for (let i = 0, code = 0; i < n; ++i) {
    if (i % width === 0) code = 0;
    code = (code + low[i]! + 256 * high[i]!) & 65535;
    if (code > 0) far[i] = Math.max(perspective ? nearest * Math.exp((code - 1) * stretch) : nearest + (code - 1) * stretch, NEAREST);
  }
  const [own, added, facing] = [summed(bytes(n), width), summed(bytes(n), width), summed(bytes(n), width)];
  const bits = bytes(Math.ceil(n / 8));
  const places = new Uint32Array(count);
  for (let i = 0, next = 0; i < n && next < count; ++i) if ((bits[i >> 3]! >> (i & 7)) & 1) places[next++] = i;
  return { width, height, step: stretch, label, far, own, added, facing, edges: { at: places, label: labels(4 * count), own: bytes(4 * count), added: bytes(4 * count), facing: bytes(4 * count) } };
}
