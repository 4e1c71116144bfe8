// Writes page.cpp, which puts the compressed files of the page into the program. Usage: embed.mjs FOLDER, where FOLDER/page is
// Vite's output. The assembler includes the files as they are: as arrays they would cost the compiler seconds.
// Their labels are hidden for the reason that tools/cli/notice.cpp gives.
import { mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { constants, gzipSync } from "node:zlib";

const folder = process.argv[2];
const page = join(folder, "page");
const packed = join(folder, "packed");
rmSync(packed, { recursive: true, force: true });
mkdirSync(packed);

const names_below = (name) =>
  readdirSync(join(page, name), { withFileTypes: true }).flatMap((entry) => {
    const below = name + entry.name;
    return entry.isDirectory() ? names_below(`${below}/`) : [below];
  });
const files = names_below("").sort().map((name, i) => {
  const path = join(packed, `${i}.gz`);
  writeFileSync(path, gzipSync(readFileSync(join(page, name)), { level: constants.Z_BEST_COMPRESSION }));
  return { name, path, symbol: `teracell_page_${i}` };
});
const text = JSON.stringify;

writeFileSync(
  join(folder, "page.cpp"),
  `// Made by web/embed.mjs.
#include "server/page/web.hpp"

${files
  .map(
    ({ path, symbol }) => `asm(R"(.pushsection .rodata
${symbol}:
.incbin ${text(path)}
${symbol}_end:
.popsection)");
extern "C" [[gnu::visibility("hidden")]] const char ${symbol}[] asm(${text(symbol)});
extern "C" [[gnu::visibility("hidden")]] const char ${symbol}_end[] asm(${text(`${symbol}_end`)});
`,
  )
  .join("")}
namespace teracell::server {

std::span<const EmbeddedFile> embedded_page() {
  static const EmbeddedFile files[] = {
${files.map(({ name, symbol }) => `    {${text(name)}, {${symbol}, ${symbol}_end}},\n`).join("")}  };
  return files;
}

}  // namespace teracell::server
`,
);
