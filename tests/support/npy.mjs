// What `teracell export` and `teracell slice` write as .npy: { shape, data }.
import { readFileSync } from "node:fs";

export function read_npy(path) {
  const file = readFileSync(path);
  const header_end = 10 + file.readUInt16LE(8);
  const header = file.toString("latin1", 10, header_end);
  const shape = header.match(/'shape': \(([^)]*)\)/)[1].split(",").filter((n) => n.trim()).map(Number);
  const bytes = new Uint8Array(file.subarray(header_end)).buffer;
  return { shape, data: header.includes("<u2") ? new Uint16Array(bytes) : new Uint8Array(bytes) };
}
