// Renews package-lock.json after a change of package.json. Usage: node lock.mjs, with npm 10 or later.
//
// Two packages are left out of it, so that `npm ci` installs the others from the registry alone. Neuroglancer takes its icons
// from a repository (bundle.mjs makes them blank), and msgpackr can do without its native part. Overrides in package.json
// were rejected: the npm of Debian 12 fails at an override for a package that does not come from the registry.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const kLeftOut = ["ikonate", "msgpackr-extract"];

const folder = mkdtempSync(join(tmpdir(), "teracell-lock-"));
const manifest = JSON.parse(readFileSync("package.json"));
for (const name of kLeftOut) {
  mkdirSync(join(folder, name));
  writeFileSync(join(folder, name, "package.json"), JSON.stringify({ name, version: "1.0.0" }));
  manifest.dependencies[name] = `file:${name}`;
}
manifest.overrides = Object.fromEntries(kLeftOut.map((name) => [name, `$${name}`]));
writeFileSync(join(folder, "package.json"), JSON.stringify(manifest));
execFileSync("npm", ["install", "--package-lock-only", "--omit-lockfile-registry-resolved"], { cwd: folder, stdio: "inherit" });

const lock = JSON.parse(readFileSync(join(folder, "package-lock.json")));
for (const name of kLeftOut) {
  delete lock.packages[name];
  delete lock.packages[`node_modules/${name}`];
}
for (const entry of Object.values(lock.packages)) {
  for (const kind of ["dependencies", "optionalDependencies"]) for (const name of kLeftOut) delete entry[kind]?.[name];
}
writeFileSync("package-lock.json", JSON.stringify(lock, null, 2) + "\n");
rmSync(folder, { recursive: true });
