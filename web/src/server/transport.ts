// Who answers what the page asks for: the server that the page came from, or the module in the page itself (module/local.ts).
export type Ask = (path: string, options: RequestInit & { priority?: "high" | "low" | "auto" }) => Promise<Response>;

let current: Ask = (path, options) => fetch(path, options);
let alone = false;
const read_here = new Map<string, boolean>(); // by id: whether a link to this page leads to the grid

export const ask: Ask = (path, options) => current(path, options);
// `make` gets who answered so far, and returns who answers from now on.
export function answer_by(make: (before: Ask) => Ask): void {
  current = make(current);
}

// There is no server: the page reads all its grids by itself.
export function be_alone(): void {
  alone = true;
}
export const is_alone = (): boolean => alone;
// What the page waits for when nothing answers.
export const answerer = (): string => (alone ? "the host of the grids" : "the server");

// The page reads this grid by itself, so no other program can have it from a server. `found`: this page finds it again by itself; a file
// that was chosen or dropped must be given to it again.
export function note_read_here(id: string, found: boolean): void {
  read_here.set(id, found);
}
export const must_be_given = (id: string): boolean => read_here.get(id) === false;
export const is_read_here = (id: string): boolean => alone || read_here.has(id);
