// The module answers what the server answers, byte for byte, from ranges of the same files; damaged files are errors in words.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { closeSync, copyFileSync, mkdirSync, openSync, readFileSync, readSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";

const { TERACELL, TERACELL_MODULE, TERACELL_BUNDLE, FORGED } = process.env;
const TERACELL_FOLDER = join(process.env.TERACELL_FOLDER, "grids");
const { Instance, is_missing } = await import(pathToFileURL(TERACELL_BUNDLE));
const module = new WebAssembly.Module(readFileSync(TERACELL_MODULE));

// The module and files of the disk, of which it gets what it asks for and nothing else.
class Files {
  static async of(paths) {
    const files = new Files(await Instance.of(module));
    for (const path of paths) files.errors.push(files.add(path));
    return files;
  }
  constructor(instance) {
    this.instance = instance;
    this.descriptors = [];
    this.errors = [];
    this.rounds = this.requests = this.bytes = 0; // of the last answer
  }
  add(path) {
    const number = this.instance.add(basename(path), statSync(path).size);
    this.descriptors[number] = openSync(path, "r");
    const { wrong, text } = this.until_there(() => this.instance.open(number));
    return wrong ? text : "";
  }
  until_there(ask) {
    this.rounds = this.requests = this.bytes = 0;
    for (;;) {
      const outcome = ask();
      if (!is_missing(outcome)) return this.instance.rest(), outcome;
      assert(++this.rounds < 100, "it asks for ever");
      for (const { file, offset, size } of outcome) {
        const bytes = new Uint8Array(size);
        assert.equal(readSync(this.descriptors[file], bytes, 0, size, offset), size);
        this.instance.give(file, offset, bytes);
        this.requests++;
        this.bytes += size;
      }
    }
  }
  answer(target) {
    return this.until_there(() => this.instance.answer(target));
  }
  close() {
    this.descriptors.forEach(closeSync);
  }
}

let server, url;
const grids = readdirSync(TERACELL_FOLDER).filter((name) => name.endsWith(".tcell")).map((name) => join(TERACELL_FOLDER, name));
before(async () => {
  server = spawn(TERACELL, ["serve", TERACELL_FOLDER, "--port", "0", "--log", "none"], { stdio: ["ignore", "pipe", "ignore"] });
  url = await new Promise((resolve) => {
    let said = "";
    server.stdout.on("data", (data) => {
      const found = /http:\/\/[^\s]+(?=\/)/.exec((said += data));
      if (found) resolve(found[0]);
    });
  });
});
after(() => server.kill());

// Of the server, and of the module.
async function same(files, path) {
  const response = await fetch(url + path, { headers: { "accept-encoding": "identity" } });
  const body = new Uint8Array(await response.arrayBuffer());
  const answer = files.answer(path);
  assert.equal(answer.status, response.status, `${path}: ${new TextDecoder().decode(answer.body.slice(0, 300))}`);
  assert.equal(answer.type, response.headers.get("content-type"), path);
  assert.equal(answer.etag, response.headers.get("etag") ?? "", path);
  assert(Buffer.compare(answer.body, body) === 0, `${path}: ${answer.body.length} bytes differ from the server's ${body.length}`);
  return answer;
}

// A sequence of numbers that is the same in each run.
function random_of(seed) {
  let state = seed;
  return (n) => {
    state = (state * 1103515245 + 12345) % 2147483648;
    return Math.floor((state / 2147483648) * n);
  };
}

for (const path of grids)
  test(`${basename(path)}: tiles, pictures, cells, columns, lines, statistics, boxes and 3D are the server's`, async () => {
    const files = await Files.of([path]);
    assert.deepEqual(files.errors, [""]);
    const id = basename(path, ".tcell");
    const api = `/api/v1/grids/${id}`;
    const info = JSON.parse(new TextDecoder().decode((await same(files, api)).body));
    const n = info.grid.cells;
    const random = random_of(7);
    const mixed = info.channels.some(({ name }) => name === "fractions");
    const small = n[0] * n[1] * n[2] < 1e7; // a tile of leaves depends on much around it
    for (let i = 0; i < 60; ++i) {
      const axis = random(3);
      const level = random(info.levels.length);
      const cells = n.map((cells) => Math.ceil(cells / 2 ** level));
      const [u, v] = [[1, 2], [0, 2], [0, 1]][axis];
      const index = random(cells[axis]);
      const place = `${"xyz"[axis]}/${index}/${level}/${random(Math.ceil(cells[u] / 512))}_${random(Math.ceil(cells[v] / 512))}`;
      await same(files, `${api}/tile/${place}.${["png", "bin", "bin?sets=1"][i % 3]}`);
      if (mixed) await same(files, `${api}/tile/${place}.bin?sets=1&shares=1`);
      if (small && i % 3 === 0) await same(files, `${api}/leaves/${place}.bin?refine=${random(6)},${1 + random(3)}`);
      const at = n.map((cells) => random(cells));
      const cell = JSON.parse(new TextDecoder().decode((await same(files, `${api}/cell?i=${at[0]}&j=${at[1]}&k=${at[2]}`)).body));
      await same(files, `${api}/column/${"xyz"[axis]}/${at[u]}_${at[v]}`);
      const to = n.map((cells, d) => at[d] + 1 + random(Math.min(cells - at[d], 90)));
      await same(files, `${api}/stats?region=${[...at, ...to].join(",")}`);
      if (i % 4 === 0) await same(files, `${api}/box.${["npy", "vtr"][random(2)]}?region=${[...at, ...to].join(",")}`);
      const line = [random(100) / 100, random(100) / 100, random(100) / 100].map((t, d) => info.grid.min[d] + t * (info.grid.max[d] - info.grid.min[d]));
      await same(files, `${api}/thickness?cell=${at.join(",")}&at=${cell.centre.join(",")}`);
      await same(files, `${api}/line?from=${info.grid.min.join(",")}&to=${line.join(",")}`);
    }
    await same(files, `${api}/stats`);
    await same(files, `${api}/leaves.json?refine=5,2&region=0,0,0,${small ? n.join(",") : "300,200,100"}`);
    await same(files, `${api}/slice/z/${n[2] >> 1}.png?level=1`);
    const middle = info.grid.min.map((low, d) => (low + info.grid.max[d]) / 2).join(",");
    for (const more of [".png?", ".bin?", ".bin?size=300,200&window=20,30,150,170&"]) await same(files, `${api}/slice/plane${more}plane=30,40,${middle}`);
    for (const from of ["3,-4,2", "-1,0.5,0.2"]) {
      const camera = `from=${from.split(",").map((f, d) => info.grid.min[d] + f * (info.grid.max[d] - info.grid.min[d])).join(",")}&size=320,240`;
      for (const more of ["", "&quick=1", "&window=100,50,180,90"]) await same(files, `${api}/view.bin?${camera}${more}`);
      await same(files, `${api}/view.json?${camera}&pixel=160.5,120.5`);
      await same(files, `${api}/view.png?${camera}`);
    }
    for (const wrong of ["/tile/z/0/0/0_0.gif", "/tile/q/0/0/0_0.png", "/cell?i=1", "/nothing", "/slice/z/99999999.png", "/slice/plane.png?plane=1,2", "/column/x/1", "/stats?region=1,2", "/leaves.json"])
      await same(files, api + wrong);
    files.close();
  });

test("several grids are listed, and compared", async () => {
  const files = await Files.of(grids);
  const list = JSON.parse(new TextDecoder().decode(files.answer("/api/v1/grids").body));
  assert.deepEqual(list.grids.map(({ id }) => id), grids.map((path) => basename(path, ".tcell")));
  await same(files, "/api/v1/grids/before/diff?with=after");
  await same(files, "/api/v1/grids/before/view.bin?size=40,30&against=after");
  await same(files, "/api/v1/grids/before/nearest?labels=1&cell=0,0,0");
  await same(files, "/api/v1/grids/before/nearest?labels=0-1");
  files.close();
});

test("an answer takes few rounds and requests, and memory stays level", async () => {
  const large = grids.find((path) => basename(path).startsWith("stadium"));
  const files = await Files.of([large]);
  const api = `/api/v1/grids/${basename(large, ".tcell")}`;
  const n = JSON.parse(new TextDecoder().decode(files.answer(api).body)).grid.cells;
  const random = random_of(3);
  let after_some = 0;
  for (let i = 0; i < 600; ++i) {
    files.answer(`${api}/tile/z/${random(n[2])}/0/${random(Math.ceil(n[0] / 512))}_${random(Math.ceil(n[1] / 512))}.bin?sets=1`);
    assert(files.rounds <= 4, `${files.rounds} rounds`);
    if (i === 200) after_some = files.instance.memory;
  }
  assert(files.instance.memory <= after_some + 8e6, `${files.instance.memory} bytes after ${after_some}`);
  files.close();
});

test("damaged, cut and foreign files are errors in words, and other grids live on", async () => {
  const whole = readFileSync(grids[0]);
  const folder = join(TERACELL_FOLDER, "damaged");
  mkdirSync(folder, { recursive: true });
  const random = random_of(11);
  for (let i = 0; i < 150; ++i) {
    const bytes = Buffer.from(whole);
    if (i % 3 === 0) bytes[random(bytes.length)] ^= 1 << random(8);
    const path = join(folder, "g.tcell");
    writeFileSync(path, i % 3 === 1 ? bytes.subarray(0, random(bytes.length)) : i % 3 === 2 ? Buffer.from(Array.from({ length: 200 + random(900) }, () => random(256))) : bytes);
    const files = await Files.of([path, grids[0]]);
    if (i % 3 > 0) assert.match(files.errors[0], /g\.tcell: .*expected|g\.tcell: /);
    else if (files.errors[0] === "")
      for (const target of ["", "/stats", "/tile/z/3/0/0_0.bin?sets=1", "/tile/x/3/0/0_0.png"]) {
        const { status, body } = files.answer(`/api/v1/grids/g${target}`);
        assert([200, 500].includes(status), `${status}`);
        if (status === 500) assert.equal(JSON.parse(new TextDecoder().decode(body)).error.code, "damaged");
      }
    assert.equal(files.answer(`/api/v1/grids/${basename(grids[0], ".tcell")}/stats`).status, 200);
    files.close();
  }
});

test("forged files, whose chunks, names or pages become large, are cells or errors in words, and other grids live on", async () => {
  const folder = join(process.env.TERACELL_FOLDER, "forged");
  mkdirSync(folder, { recursive: true });
  execFileSync(FORGED, ["--write", folder, "4"]);
  for (const file of readdirSync(folder).filter((name) => name.endsWith(".txt"))) {
    const [what, ...targets] = readFileSync(join(folder, file), "utf8").trim().split("\n");
    copyFileSync(join(folder, file.replace(".txt", ".tcell")), join(folder, "g.tcell"));
    const files = await Files.of([join(folder, "g.tcell"), grids[0]]);
    if (files.errors[0] !== "") assert.match(files.errors[0], /g\.tcell: /, what);
    // Whole boxes are large answers, which take seconds.
    else
      for (const target of targets.filter((address, i) => i % 53 === 0 && !address.includes("/box."))) {
        const { status, body } = files.answer(target);
        assert([200, 400, 404, 500].includes(status), `${what}: ${target} is answered with ${status}`);
        if (status !== 200) assert(JSON.parse(new TextDecoder().decode(body)).error.message.length > 20, `${what}: ${target}`);
      }
    assert.equal(files.answer(`/api/v1/grids/${basename(grids[0], ".tcell")}/stats`).status, 200, what);
    files.close();
  }
});
