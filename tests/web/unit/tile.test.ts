// Reads a tile's bytes as the server writes them, and as they are when they are cut at any byte.
import assert from "node:assert/strict";
import test from "node:test";
import type { Place } from "@page/tiles/place";
import { SetTable } from "@page/tiles/sets";
import { decode_tile, set_at } from "@page/tiles/tile";

const place: Place = { axis: 2, index: 5, level: 3, column: 1, row: 2 };

function encoded(sets: readonly (readonly number[])[], labels: readonly number[]): ArrayBuffer {
  const words = [sets.length, 0, ...sets.flatMap((set) => [set.length, ...set])];
  const wide = sets.length > 256;
  const bytes = new Uint8Array(2 * words.length + labels.length * (wide ? 2 : 1));
  const view = new DataView(bytes.buffer);
  words.forEach((word, i) => view.setUint16(2 * i, word, true));
  labels.forEach((label, i) => (wide ? view.setUint16(2 * (words.length + i), label, true) : view.setUint8(2 * words.length + i, label)));
  return bytes.buffer;
}

for (const count of [1, 2, 256, 257, 1000])
  test(`the sets of all cells are read, with ${count} of them in the tile`, () => {
    const table = new SetTable();
    table.number_of([7]); // known from another tile
    const sets = Array.from({ length: count }, (_, i) => (i === 0 ? [] : i % 3 ? [i] : [i, i + 1, 65535]));
    const [width, height] = [37, 29];
    const labels = Array.from({ length: width * height }, (_, i) => (i * 7919) % count);
    const tile = decode_tile(place, [width, height], encoded(sets, labels), table);
    for (let v = 0; v < height; ++v)
      for (let u = 0; u < width; ++u) {
        // Any cell of level 0 below the cell.
        const number = set_at(tile, (512 * place.column + u) * 8 + (u % 8), (512 * place.row + v) * 8 + (v % 8));
        assert.deepEqual(table.members(number), sets[labels[v * width + u]!]);
      }
  });

test("labels of four bytes are read, and whether bodies are told apart", () => {
  const words = (flags: number) => [1, flags, 2, 0, 7, 0, 0x1234, 2].map((word) => [word & 255, word >> 8]).flat();
  const table = new SetTable();
  const tile = decode_tile(place, [1, 1], new Uint8Array([...words(1), 0]).buffer, table);
  assert.deepEqual(table.members(tile.sets[0]!), [7, 0x21234]);
  assert.equal(tile.apart, true);
  assert.equal(decode_tile(place, [1, 1], new Uint8Array([...words(3), 0]).buffer, table).apart, false);
});

test("bytes that do not form a tile are refused, whatever is missing or too much", () => {
  const whole = new Uint8Array(encoded([[0], [1, 2]], Array.from({ length: 12 }, (_, i) => i % 2)));
  const decode = (bytes: Uint8Array) => decode_tile(place, [4, 3], bytes.slice().buffer, new SetTable());
  decode(whole);
  for (let length = 0; length < whole.length; ++length) assert.throws(() => decode(whole.subarray(0, length)), /expected/, `${length} bytes`);
  assert.throws(() => decode(new Uint8Array([...whole, 0])), /expected/);
});

test("the same set has the same number in all tiles", () => {
  const table = new SetTable();
  const a = decode_tile(place, [1, 1], encoded([[1, 2]], [0]), table);
  const b = decode_tile({ ...place, row: 0 }, [2, 1], encoded([[3], [1, 2]], [0, 1]), table);
  assert.equal(a.sets[0], b.sets[1]);
  assert.notEqual(b.sets[0], b.sets[1]);
});

test("a mixed cell has its labels once, its own look, and the owner that it has without its shares", () => {
  const table = new SetTable();
  const shares = [3, 3, 3, 3, 3, 1, 1, 1, 1, 1, 1, 1, 1, 4, 4, 4];
  const tile = decode_tile(place, [3, 1], encoded([[3], shares, [1, 3, 4]], [0, 1, 2]), table);
  const mixed = tile.sets[1]!;
  assert.deepEqual(table.members(mixed), [1, 3, 4]);
  const looks = [0, 1, 2, 3, 4].map((material) => ({ color: [10 * material, 0, 0] as [number, number, number], opacity: material === 4 ? 0 : 1, visible: true, material }));
  assert.deepEqual(table.color(mixed, looks), [Math.round((5 * 30 + 8 * 10) / 13), 0, 0, Math.round((255 * 13) / 16)]);
  assert.deepEqual(table.color(mixed, looks.map((look, i) => ({ ...look, visible: i !== 3 }))), [10, 0, 0, Math.round(255 / 2)]);
  assert.equal(tile.owners[1], tile.sets[0]);
  assert.equal(tile.owners[0], tile.sets[0]);
  assert.equal(tile.owners[2], tile.sets[2]);
  assert.notEqual(mixed, tile.sets[2]);
});

test("a set of sixteen labels is a set", () => {
  const table = new SetTable();
  const set = Array.from({ length: 16 }, (_, i) => 3 * i);
  const tile = decode_tile(place, [1, 1], encoded([set], [0]), table);
  assert.deepEqual(table.members(tile.sets[0]!), set);
  assert.equal(tile.owners[0], tile.sets[0]);
});
