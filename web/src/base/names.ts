// Names of grids, and in lists: how they are ordered and found.

export const by_name = new Intl.Collator("en", { numeric: true }).compare; // wheel 2 before wheel 10

// Whether a text contains another one, in whatever case.
export const contains = (text: string, wanted: string): boolean => text.toLowerCase().includes(wanted.trim().toLowerCase());

// A grid has the name of its file.
export const stem_of = (file: string): string => file.replace(/\.tcell$/, "");
