// Who answers what the page asks for: the server that the page came from, or the module in the page itself (module/local.ts).
export type Ask = (path: string, options: RequestInit & { priority?: "high" | "low" | "auto" }) => Promise<Response>;

let current: Ask = (path, options) => fetch(path, options);

export const ask: Ask = (path, options) => current(path, options);
// `make` gets who answered so far, and returns who answers from now on.
export function answer_by(make: (before: Ask) => Ask): void {
  current = make(current);
}
