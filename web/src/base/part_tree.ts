// Names of bodies that are paths of parts, "/as1/rod assembly/nut#2", as the tree that they describe.

export interface Leaf {
  readonly name: string;
  readonly place: number; // in the list of all names
}
export interface Branch {
  readonly name: string; // of a chain of branches that have nothing else: "as1 / rod assembly"
  readonly path: string; // no other branch has it
  readonly places: readonly number[]; // of all that is below it
  readonly children: readonly (Branch | Leaf)[]; // in the order of the list
}
export const is_branch = (child: Branch | Leaf): child is Branch => "children" in child;

// "/as1", "/rod assembly", "/nut#2". What begins with no slash is one name.
const steps_of = (path: string): readonly string[] => (path.startsWith("/") ? path.match(/\/(?:\\[^]|[^/\\]|\\$)*/gu)! : [path]);

// Without the backslashes that stand before / * ? [ \ in a path.
const name_of = (step: string): string => step.replace(/^\//, "").replace(/\\([^])/gu, "$1");

interface Growing {
  name: string;
  path: string;
  places: number[];
  children: (Growing | Leaf)[];
}

const all_joined = (children: readonly (Growing | Leaf)[]) => children.map((child) => ("children" in child ? joined(child) : child));

function joined({ name, path, places, children }: Growing): Branch {
  const shown = all_joined(children);
  const only = shown[0]!;
  return shown.length === 1 && is_branch(only) ? { ...only, name: `${name} / ${only.name}` } : { name, path, places, children: shown };
}

// null when no name has a branch. A part that has parts below it is in their branch.
export function part_tree(list: readonly string[]): readonly (Branch | Leaf)[] | null {
  const root: Growing = { name: "", path: "", places: [], children: [] };
  const branches = new Map([["", root]]);
  // A branch is made where its first part is.
  const branch_at = (steps: readonly string[]): Growing => {
    const path = steps.join("");
    const known = branches.get(path);
    if (known) return known;
    const made = { name: name_of(steps[steps.length - 1]!), path, places: [], children: [] };
    branches.set(path, made);
    branch_at(steps.slice(0, -1)).children.push(made);
    return made;
  };
  const ways = list.map(steps_of);
  const above = new Set(ways.flatMap((steps) => steps.map((_, n) => steps.slice(0, n).join(""))));
  ways.forEach((steps, place) => {
    const own = above.has(list[place]!) ? steps : steps.slice(0, -1);
    branch_at(own).children.push({ name: name_of(steps[steps.length - 1]!), place });
    for (let n = 1; n <= own.length; ++n) branches.get(own.slice(0, n).join(""))!.places.push(place);
  });
  return branches.size > 1 ? all_joined(root.children) : null;
}
