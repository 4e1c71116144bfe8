// What to do with a file that was given to the page and is no grid, by its name: the page reads grids, and the program makes them. Pure.
import type { Below } from "../base/messages";
import { quoted } from "../base/shell";

const SURFACES = ["stl", "obj", "ply", "off", "3mf", "gltf", "glb", "step", "stp"];

export interface Advice extends Below {
  readonly text: string;
  readonly command: string;
}

// `reads`: whether the page reads grids by itself. null: nothing but reading the file will tell.
export function advice_for(name: string, reads: boolean): Advice | null {
  const [, stem, ending] = /^(.+)\.(\w+)$/.exec(name) ?? [];
  if (!stem || !ending) return null;
  const kind = ending.toLowerCase();
  const grid = `${stem}.tcell`;
  const then = reads ? `then drop ${grid} here` : `then serve ${grid}, or put it into the folder that is served`;
  if (SURFACES.includes(kind))
    return { text: `${name} is a surface, and no grid yet. Mesh it, ${then}:`, command: `teracell mesh ${quoted(name)} --cells 200 -o ${quoted(grid)}` };
  if (kind === "json") return { text: `${name} may be a scene. If so, mesh it, ${then}:`, command: `teracell mesh ${quoted(name)} -o ${quoted(grid)}` };
  if (kind === "tcell" && !reads)
    return { text: `This page was built without what reads files. A server gives it ${name}:`, command: `teracell serve ${quoted(name)}` };
  return null;
}
