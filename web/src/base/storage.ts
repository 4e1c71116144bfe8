// Uses what the browser keeps for the page. That may be forbidden, as in frames of other sites: then null comes back.
export function if_allowed<T>(use_storage: () => T): T | null {
  try {
    return use_storage();
  } catch {
    return null;
  }
}
