// What has a name in a grid and lies somewhere: bodies, parts of assemblies with all that is below them, and materials.
import { noun } from "../base/format";
import type { GridInfo } from "../base/grid";
import { by_name, contains } from "../base/names";
import { type Branch, type Leaf, is_branch, part_tree } from "../base/part_tree";
import type { Viewer } from "./viewer";

export interface NamedPlace {
  readonly name: string;
  readonly kind: string; // as people read it: "body", "part of 12 bodies"
  readonly of: "bodies" | "materials";
  readonly ids: readonly number[]; // labels of bodies, or ids of materials
}

const branches_of = (list: readonly (Branch | Leaf)[]): Branch[] => list.flatMap((child) => (is_branch(child) ? [child, ...branches_of(child.children)] : []));

type Named = Pick<Viewer, "labels" | "info" | "keeps_bodies">;

// Where the file keeps materials: that of a body, if other bodies have it too, so that its name leads to all of them.
export function shared_material({ info, keeps_bodies }: Omit<Named, "labels">, name: string): string | null {
  const bodies = keeps_bodies ? [] : (info.report.scene?.bodies ?? []);
  const material = bodies.find((body) => body.name === name)?.material;
  return bodies.some((body) => body.material === material && body.name !== name) ? material! : null;
}

// Where the file keeps materials.
function places_of_bodies({ materials, report }: GridInfo): NamedPlace[] {
  const bodies = report.scene?.bodies ?? [];
  const numbers = new Map<string, number>();
  for (const { material } of bodies) numbers.set(material, (numbers.get(material) ?? 0) + 1);
  const ids = new Map(materials.slice(1).map(({ id, name }) => [name, id]));
  return bodies.flatMap(({ name, material }) => {
    const id = ids.get(material);
    const kind = numbers.get(material) === 1 ? "body" : `body; leads to all of ${material}`;
    return id === undefined || name === material ? [] : [{ name, kind, of: "materials" as const, ids: [id] }];
  });
}

// The background has no place of its own.
export function named_places({ labels, info, keeps_bodies }: Named): NamedPlace[] {
  const bodies = keeps_bodies ? labels.flatMap(({ body, overlap }, id) => (body && !overlap ? [{ name: body, kind: "body", of: "bodies" as const, ids: [id] }] : [])) : [];
  const materials = info.materials.slice(1).map(({ id, name }) => ({ name, kind: "material", of: "materials" as const, ids: [id] }));
  const items = keeps_bodies ? bodies : materials;
  const parts = branches_of(part_tree(items.map(({ name }) => name)) ?? []).map(({ path, places }) => ({
    name: path,
    kind: `part of ${places.length} ${keeps_bodies ? noun(places.length, "body", "bodies") : noun(places.length, "material")}`,
    of: items[0]!.of,
    ids: places.map((place) => items[place]!.ids[0]!),
  }));
  return [...parts, ...(keeps_bodies ? bodies : places_of_bodies(info)), ...materials];
}

// Those whose names contain a text: the whole name first, then what begins with it, or has a step of its path that does.
export function places_named(list: readonly NamedPlace[], text: string, most: number): NamedPlace[] {
  const wanted = text.trim().toLowerCase();
  if (wanted === "") return [];
  const rank = ({ name }: NamedPlace) => {
    const own = name.toLowerCase();
    return own === wanted || own === `/${wanted}` ? 0 : own.startsWith(wanted) || own.includes(`/${wanted}`) ? 1 : 2;
  };
  return list
    .filter(({ name }) => contains(name, wanted))
    .map((place) => ({ place, rank: rank(place) }))
    .sort((a, b) => a.rank - b.rank || by_name(a.place.name, b.place.name))
    .slice(0, most)
    .map(({ place }) => place);
}
