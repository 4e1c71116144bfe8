// What stands in while tiles are on their way: every cell of the view is drawn once, from the best tile that is there.
import assert from "node:assert/strict";
import test from "node:test";
import { type Place, coarser, extent_of, place_name } from "@page/tiles/place";
import { regions_of } from "@page/tiles/regions";
import type { Tile } from "@page/tiles/tile";
import { random_of, whole } from "./random";

const cells: [number, number, number] = [5000, 3000, 700];
const levels = 14;
const tile_of = (place: Place): Tile => ({ place, name: place_name(place), width: 1, height: 1, sets: new Uint32Array(1), owners: new Uint32Array(1), labels: null, apart: true, bytes: 1 });

function places_of(level: number, slice: number): Place[] {
  const size = 512 * 2 ** level;
  const places: Place[] = [];
  for (let row = 0; row * size < cells[1]; ++row)
    for (let column = 0; column * size < cells[0]; ++column) places.push({ axis: 2, index: slice >> level, level, column, row });
  return places;
}

function holder(tiles: readonly Place[], damaged: readonly Place[] = []) {
  const held = new Map(tiles.map((place) => [place_name(place), tile_of(place)]));
  const names = new Set(damaged.map(place_name));
  return { find: (place: Place) => held.get(place_name(place)) ?? null, is_damaged: (place: Place) => names.has(place_name(place)) };
}

test("whatever tiles are there, every cell of the view is drawn once, from a tile that covers it", () => {
  const random = random_of(5);
  for (let round = 0; round < 60; ++round) {
    const [level, slice, before] = [whole(random, 1, 4), whole(random, 0, 699), whole(random, 0, 699)];
    const there: Place[] = [];
    for (const s of [slice, before])
      for (let l = 0; l < levels; ++l) for (const place of places_of(l, s)) if (random() < [0.05, 0.3, 0.6][round % 3]!) there.push(place);
    const places = places_of(level, slice);
    const shown = regions_of(places, slice, levels, cells, holder(there), { slice: round % 5 ? before : null, patient: round % 2 === 0 });
    const area = shown.regions.reduce((sum, r) => sum + (r.u1 - r.u0) * (r.v1 - r.v0), 0);
    assert.equal(area, cells[0] * cells[1]);
    for (const region of shown.regions) {
      assert.ok(region.u0 < region.u1 && region.v0 < region.v1);
      if (!region.tile) continue;
      const e = extent_of(region.tile.place, cells);
      assert.ok(e.u0 <= region.u0 && e.u1 >= region.u1 && e.v0 <= region.v0 && e.v1 >= region.v1);
      const own = region.tile.place.index === slice >> region.tile.place.level;
      assert.ok(own || region.tile.place.index === before >> region.tile.place.level);
      assert.ok(own || shown.stale, "another slice is shown without `stale`");
    }
    assert.deepEqual(
      shown.missing.map(place_name),
      places.filter((place) => !there.some((t) => place_name(t) === place_name(place))).map(place_name),
    );
  }
});

test("a tile that is there is drawn, and nothing is asked for", () => {
  const places = places_of(2, 100);
  const shown = regions_of(places, 100, levels, cells, holder([...places, ...places_of(3, 100), ...places_of(1, 100)]), { slice: 99, patient: true });
  assert.deepEqual(shown.regions.map((r) => r.tile!.name), places.map(place_name));
  assert.deepEqual([shown.missing, shown.blank, shown.stale], [[], [], false]);
});

test("a tile one level coarser of the same slice is preferred to what was shown before", () => {
  const places = places_of(2, 100);
  const shown = regions_of(places, 100, levels, cells, holder([...places_of(3, 100), ...places_of(2, 99)]), { slice: 99, patient: true });
  assert.ok(shown.regions.every((r) => r.tile!.place.level === 3 && r.tile!.place.index === 100 >> 3));
  assert.equal(shown.missing.length, places.length);
  assert.deepEqual([shown.blank, shown.stale], [[], false]);
});

test("for a moment, what was shown before is preferred to a very coarse tile, and then no longer", () => {
  const places = places_of(0, 96);
  const top = coarser(places[0]!, levels - 1);
  const held = holder([...places_of(0, 101), top]);
  const patient = regions_of(places, 96, levels, cells, held, { slice: 101, patient: true });
  assert.ok(patient.stale && patient.regions.every((r) => r.tile!.place.index === 101));
  const later = regions_of(places, 96, levels, cells, held, { slice: 101, patient: false });
  assert.ok(!later.stale && later.regions.every((r) => r.tile!.place.level === levels - 1));
  assert.equal(later.blank.length, places.length);
});

test("a damaged tile is reported as damaged, and not asked for again", () => {
  const places = places_of(2, 100);
  const shown = regions_of(places, 100, levels, cells, holder(places.slice(1), places.slice(0, 1)), { slice: null, patient: false });
  assert.deepEqual(shown.regions.map((r) => r.damaged), places.map((_, i) => i === 0));
  assert.deepEqual(shown.missing, []);
});
