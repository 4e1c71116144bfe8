// Names of grids, and in lists: how they are ordered and found, and the first of many.
import { grouped } from "./format";

export const by_name = new Intl.Collator("en", { numeric: true }).compare; // wheel 2 before wheel 10

// Whether a text contains another one, in whatever case.
export const contains = (text: string, wanted: string): boolean => text.toLowerCase().includes(wanted.trim().toLowerCase());

// A grid has the name of its file.
export const stem_of = (file: string): string => file.replace(/\.tcell$/, "");

const FEW = 8;

export const some_names = (names: readonly string[]): string =>
  names.length > FEW ? `${names.slice(0, FEW).join(", ")} and ${grouped(names.length - FEW)} more` : names.join(", ");
