// The page without a server, in real browsers: from a plain nginx, from a disk, with files that are given to it. What it shows is held against
// the same page from `teracell serve`, pixel by pixel.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, readFileSync, renameSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer as http_server } from "node:http";
import { createServer } from "node:net";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { launch_options } from "../support/chromium.mjs";
import { close, folder, grid_file, open_grid, open_page, pixels, serve, settled } from "../web/support.mjs";

const { chromium, _bidiFirefox } = createRequire(new URL("../../web/package.json", import.meta.url))("playwright-core");
const teracell = (...args) => execFileSync(process.env.TERACELL, args, { stdio: ["ignore", "ignore", "pipe"] });

const free_port = () =>
  new Promise((resolve) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });

// A host of static files. /open/ may be read by pages of other origins. /whole/ answers no ranges, and nothing of it is kept: of a whole file
// in its cache a browser itself answers ranges.
class Host {
  static async of(root) {
    const host = new Host(root, await free_port());
    await host.start();
    return host;
  }
  constructor(root, port) {
    this.root = root;
    this.url = `http://127.0.0.1:${port}`;
    const conf = `daemon off; pid ${root}.pid; error_log ${root}.log;
      events {} http { access_log off; client_body_temp_path ${root}.tmp; proxy_temp_path ${root}.tmp; fastcgi_temp_path ${root}.tmp;
      uwsgi_temp_path ${root}.tmp; scgi_temp_path ${root}.tmp; types { text/html html; text/javascript js; text/css css; }
      server { listen 127.0.0.1:${port}; root ${root};
        location /whole/ { alias ${root}/; max_ranges 0; add_header Cache-Control no-store; }
        location /open/ { alias ${root}/; add_header Access-Control-Allow-Origin *; add_header Access-Control-Allow-Headers Range;
          add_header Access-Control-Expose-Headers "Content-Range, ETag";
          if ($request_method = OPTIONS) { return 204; } } } }`;
    writeFileSync(`${root}.conf`, conf);
  }
  async start() {
    this.child = spawn("/usr/sbin/nginx", ["-e", `${this.root}.log`, "-c", `${this.root}.conf`], { stdio: "ignore" });
    for (let i = 0; i < 100; ++i) {
      if (await fetch(`${this.url}/none`).then(() => true, () => false)) return;
      await new Promise((done) => setTimeout(done, 50));
    }
    throw new Error("nginx does not start");
  }
  async stop() {
    const ended = new Promise((done) => this.child.on("exit", done));
    this.child.kill("SIGTERM");
    await ended;
  }
}

let browser, server, host;
const site = join(folder, "site");
before(async () => {
  teracell("page", "-o", site, "--grids", grid_file("stadium"), grid_file("mixed"));
  [browser, server, host] = await Promise.all([chromium.launch(launch_options), serve(join(folder, "grids")), Host.of(site)]);
});
after(async () => {
  await browser?.close();
  await host?.stop();
  assert.deepEqual(await server?.stop(), []);
});

const AXES = ["x", "y", "z"];
const views = async (page) => Promise.all(AXES.map(async (axis) => Buffer.from((await pixels(page, axis)).data.buffer).toString("base64")));
const panel = (page) => page.locator("#panel-content").innerText();

// Whether a page shows what the page of the server shows, also after it was moved.
async function expect_as_served(page, grid) {
  const served = await open_grid(browser, `${server.url}#g=${grid}`);
  // How soon a page knows where to look first is no matter of these tests.
  const all = (t) => {
    t.viewer.set_cell(t.viewer.cells.map((n) => n >> 1));
    t.viewer.centre.value = t.viewer.middle();
    t.viewer.zoom.value = 0;
  };
  for (const move of [all, (t) => t.viewer.set_slice(2, 40), (t) => (t.viewer.zoom.value *= 6)]) {
    for (const one of [page, served]) {
      await one.evaluate(`(${move})(window.teracell)`);
      await settled(one);
    }
    assert.deepEqual(await views(page), await views(served));
  }
  await page.waitForFunction(() => /\d/.test(document.querySelector("#panel-content").innerText));
  await served.waitForFunction(() => /\d/.test(document.querySelector("#panel-content").innerText));
  assert.equal(await panel(page), await panel(served));
  await close(served);
}

// Whether it says of the grid what the server's page says, which `teracell check` has found.
async function expect_findings(page, name) {
  const served = await open_grid(browser, `${server.url}#g=${name}`);
  for (const one of [page, served]) {
    await one.click("#tab-report");
    await one.waitForFunction(() => {
      const text = document.querySelector("#panel-content").innerText;
      return /\d+ (error|warning|note)s?[:,.]/.test(text) && !text.includes("Not checked yet");
    });
  }
  assert.equal(await panel(page), await panel(served));
  await close(served);
}

test("a folder on a plain host: the page shows what the server's shows, and speaks of no server", async () => {
  const page = await open_grid(browser, `${host.url}/#g=stadium`);
  await expect_as_served(page, "stadium");
  assert.equal(await page.locator("#tab-status").count(), 0);
  await page.click("#tab-share");
  assert.doesNotMatch(await panel(page), /Open in Neuroglancer|zarr\.open/);
  await close(page);
  const checked = await open_grid(browser, `${host.url}/#g=mixed`);
  await expect_findings(checked, "mixed");
  await close(checked);
  const list = await open_page(browser, `${host.url}/`);
  await list.waitForSelector(".card h2");
  assert.deepEqual(await list.locator(".card h2").allInnerTexts(), ["stadium", "mixed"]);
  assert.equal(await list.getByText("Addresses for other programs").count(), 0);
  await close(list);
});

test("what a page can't be made of is refused, and nothing is written", () => {
  for (const [args, status, words] of [
    [["--grids", "s3://bucket/g.tcell", "-o", join(folder, "refused")], 2, /a browser reads https:\/\/ addresses only/],
    [["-o", join(folder, "refused.html")], 2, /expected the grids that are to be in the page/],
    [[join(folder, "cube.stl"), "-o", join(folder, "refused.html")], 1, /cube\.stl: .*not a teracell file/],
    [["--grids", join(folder, "none.tcell"), "-o", join(folder, "refused")], 1, /none\.tcell/],
  ]) {
    assert.throws(() => teracell("page", ...args), (error) => error.status === status && words.test(error.stderr.toString()), words);
    assert(!existsSync(args.at(-1)));
  }
});

test("save as one file writes what `teracell page` writes", async () => {
  const file = join(folder, "stadium.html");
  teracell("page", grid_file("stadium"), "-o", file);
  assert(statSync(file).size <= 1.4 * statSync(grid_file("stadium")).size + 1.5e6);
  for (const url of [host.url, server.url]) {
    const page = await open_grid(browser, new URL("#g=stadium", url).href);
    await page.click("#tab-share");
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("Save as one file").click()]);
    assert.equal(download.suggestedFilename(), "stadium.html");
    assert(readFileSync(await download.path()).equals(readFileSync(file)), url);
    await close(page);
  }
});

test("one HTML file opens from a disk, without a network", async () => {
  const page = await open_page(browser, "about:blank");
  await page.context().setOffline(true);
  await page.goto(pathToFileURL(join(folder, "stadium.html")).href);
  await settled(page);
  await expect_as_served(page, "stadium");
  await page.getByLabel("Help").click();
  const [notice] = await Promise.all([page.context().waitForEvent("page"), page.getByText("Licences of the third-party").click()]);
  await notice.waitForLoadState();
  assert.match(await notice.locator("body").innerText(), /three/);
  await close(page);
});

test("in one HTML file there are the tree of parts, mixed cells with their planes, leaves and thickness, as served", async () => {
  const file = join(folder, "parts.html");
  teracell("page", grid_file("parts"), "-o", file);
  const page = await open_page(browser, "about:blank");
  await page.context().setOffline(true);
  const hash = "#g=parts&at=3,3,3&layout=z&shares=1&leaves=1&refine=3,1";
  await page.goto(pathToFileURL(file).href + hash);
  const served = await open_grid(browser, `${server.url}${hash}`);
  for (const one of [page, served]) await settled(one);
  const slice = async (one) => Buffer.from((await pixels(one, "z")).data.buffer).toString("base64");
  assert.equal(await slice(page), await slice(served));
  for (const [tab, said] of [["bodies", "car"], ["leaves", "leaves"]]) {
    for (const one of [page, served]) {
      await one.click(`#tab-${tab}`);
      await one.waitForFunction((word) => document.querySelector("#panel-content").innerText.includes(word), said);
      await one.waitForFunction(() => /\d/.test(document.querySelector("#panel-content").innerText) && !document.querySelector("#panel-content [aria-busy=true]"));
    }
    await page.waitForTimeout(500);
    assert.equal(await panel(page), await panel(served), tab);
  }
  await expect_findings(page, "parts");
  // The shares of a mixed cell and its plane, beside the pointer.
  const [mixed] = await served.evaluate(async () => {
    for (let i = 0; i < 12; ++i)
      for (let j = 0; j < 12; ++j) {
        const cell = await (await fetch(`api/v1/grids/parts/cell?i=${i}&j=${j}&k=3`)).json();
        if (cell.plane) return [cell.index];
      }
    return [];
  });
  assert.ok(mixed, "no cell is mixed");
  const cut = async (one) => {
    await one.evaluate((cell) => (teracell.viewer.hover.value = { axis: 2, cell, point: teracell.viewer.centre_of(cell), labels: null }), mixed);
    return (await one.waitForFunction(() => teracell.viewer.cut.value)).jsonValue();
  };
  assert.deepEqual(await cut(page), await cut(served));
  for (const one of [page, served]) {
    await one.evaluate(() => (teracell.viewer.layout.value = "3d"));
    await one.waitForSelector('.overview[data-state="sharp"]');
    const { left, top, width, height } = await one.locator(".overview > canvas").evaluate((e) => e.getBoundingClientRect().toJSON());
    await one.keyboard.down("Shift");
    await one.mouse.click(left + 0.45 * width, top + 0.55 * height);
    await one.keyboard.up("Shift");
    await one.waitForFunction(() => teracell.viewer.measures.value.length === 1);
  }
  const measures = (one) => one.evaluate(() => teracell.viewer.measures.value);
  assert.deepEqual(await measures(page), await measures(served));
  await close(page);
  await close(served);
});

test("one HTML file opens in Firefox", { skip: !existsSync("/usr/bin/firefox-esr") && "firefox-esr is not installed" }, async () => {
  const firefox = await _bidiFirefox.launch({ executablePath: "/usr/bin/firefox-esr" });
  const page = await firefox.newPage({ viewport: { width: 1400, height: 900 } });
  await page.goto(`${pathToFileURL(join(folder, "stadium.html")).href}#g=stadium&at=9,9,9`);
  await page.waitForFunction(() => window.teracell?.idle() === true, null, { polling: 100 });
  const served = await open_grid(browser, `${server.url}#g=stadium&at=9,9,9`);
  assert.deepEqual(await views(page), await views(served));
  await close(served);
  await firefox.close();
});

test("files that are chosen or dropped are read in the page", async () => {
  const empty = join(folder, "empty");
  teracell("page", "-o", empty);
  const alone = await Host.of(empty);
  const page = await open_page(browser, alone.url);
  await page.getByText("nothing is uploaded").waitFor();
  await page.screenshot({ path: join(folder, "empty.png") });
  await page.locator("input[type=file]").setInputFiles(grid_file("mixed"));
  await settled(page);
  await expect_as_served(page, "mixed");
  await page.evaluate((text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], "before.tcell"));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, readFileSync(grid_file("before")).toString("base64"));
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "before");
  await settled(page);
  await expect_as_served(page, "before");
  await close(page);
  await alone.stop();
});

test("what can't be read is said in words, and the page lives", async () => {
  const whole = readFileSync(grid_file("mixed"));
  const bad = join(folder, "bad");
  mkdirSync(bad, { recursive: true });
  writeFileSync(join(bad, "cut.tcell"), whole.subarray(0, whole.length - 1000));
  writeFileSync(join(bad, "foreign.tcell"), "solid cube");
  const damaged = Buffer.from(whole);
  for (let at = 4096; at < damaged.length - 65536; at += 4096) damaged[at] ^= 1;
  writeFileSync(join(bad, "damaged.tcell"), damaged);
  const page = await open_page(browser, `${host.url}/`);
  await page.waitForSelector(".card h2");
  await page.locator("input[type=file]").setInputFiles(["cut", "foreign"].map((name) => join(bad, `${name}.tcell`)));
  await page.getByText("cut.tcell can't be read").waitFor();
  await page.waitForFunction(() => document.querySelectorAll(".card.unreadable").length === 2);
  await page.screenshot({ path: join(folder, "unreadable.png") });
  for (const text of await page.locator(".card.unreadable p").allInnerTexts()) assert.match(text, /expected|found|teracell/);
  await page.locator("input[type=file]").setInputFiles(join(bad, "damaged.tcell"));
  await page.getByText("“damaged” is damaged").first().waitFor();
  await page.evaluate(() => void (location.hash = "#g=stadium"));
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "stadium");
  await settled(page);
  await close(page);
});

test("a page that is cut, that has no module, or whose module is damaged says so", async () => {
  const whole = readFileSync(join(folder, "stadium.html"), "utf8");
  const begin = whole.indexOf('<script id="module"');
  const broken = {
    cut: whole.slice(0, whole.length - 3000),
    damaged: `${whole.slice(0, begin + 2000)}A${whole.slice(begin + 2001)}`.replace("AAAA", "BBBB"),
    none: whole.slice(0, begin) + whole.slice(whole.indexOf("</script>", begin) + 9),
  };
  for (const [name, words] of [["cut", /cut on its way/], ["damaged", /stadium[^]*(cut or damaged|can't be started)/], ["none", /stadium[^]*(cut or damaged|can't be started)/]]) {
    const file = join(folder, `${name}.html`);
    writeFileSync(file, broken[name]);
    const page = await open_page(browser, pathToFileURL(file).href);
    await page.waitForFunction(() => document.body.innerText.trim().length > 40 && document.querySelector(".not-started, .card.unreadable"));
    assert.match(await page.locator(".not-started, .card.unreadable").first().innerText(), words);
    await page.screenshot({ path: join(folder, `${name}.png`) });
    await page.context().close();
  }
});

test("a file that is given to a served page does not take the place of a served grid of its name", async () => {
  const page = await open_page(browser, server.url);
  await page.waitForSelector(".card h2");
  await page.locator("input[type=file]").setInputFiles({ name: "mixed.tcell", mimeType: "", buffer: readFileSync(grid_file("before")) });
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "mixed-2");
  await page.getByText("mixed.tcell is “mixed-2” here: there is another “mixed”.").waitFor();
  const materials = () => page.evaluate(() => teracell.viewer.info.materials.length);
  const own = await materials();
  await page.evaluate(() => (location.hash = "#g=mixed"));
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "mixed");
  assert.notEqual(await materials(), own);
  await close(page);
});

test("files that are dropped one right after the other keep their names", async () => {
  const page = await open_page(browser, `${host.url}/`);
  await page.waitForSelector(".card h2");
  await page.evaluate(
    (texts) => {
      for (const [name, text] of texts) {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
        document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
      }
    },
    ["before", "after"].map((name) => [`${name}.tcell`, readFileSync(grid_file(name)).toString("base64")]),
  );
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "after");
  for (const name of ["before", "after"]) {
    await page.evaluate((id) => (location.hash = `#g=${id}`), name);
    await page.waitForFunction((id) => window.teracell?.viewer.info.id === id, name);
    await settled(page);
    await expect_as_served(page, name);
  }
  await close(page);
});

test("addresses: a host that may be read, one that may not, one without ranges, and none", async () => {
  const other = host.url.replace("127.0.0.1", "other.test");
  for (const of of [host.url, server.url]) {
    const fine = await open_grid(browser, new URL(`?grid=${encodeURIComponent(`${other}/open/stadium.tcell`)}`, of).href);
    assert.equal(await fine.evaluate(() => window.teracell.viewer.info.id), "stadium");
    await expect_as_served(fine, "stadium");
    await close(fine);
  }
  for (const [address, words] of [
    [`${other}/stadium.tcell`, /must allow this page's origin and the header Range, and expose Content-Range and ETag/],
    ["/whole/stadium.tcell", /sends whole files only; a host that answers ranges of bytes is needed/],
    ["/none.tcell", /answered 404/],
    ["https://", /can't be read/],
  ]) {
    const page = await open_page(browser, `${host.url}/?grid=${encodeURIComponent(address)}`, { expected: () => true });
    assert.match(await page.locator(".card.unreadable").innerText(), words);
    await page.context().close();
  }
});

test("a file that is replaced, and a host that is lost for a while", async () => {
  copyFileSync(grid_file("stadium"), join(site, "changing.tcell"));
  const page = await open_grid(browser, `${host.url}/?grid=changing.tcell`, { expected: () => true });
  copyFileSync(grid_file("mixed"), join(site, "next.tcell"));
  renameSync(join(site, "next.tcell"), join(site, "changing.tcell"));
  await page.evaluate(() => (window.teracell.viewer.zoom.value *= 8));
  await page.getByText("This grid was meshed again").waitFor();
  await page.getByRole("button", { name: "Reload" }).click();
  await page.waitForFunction(() => window.teracell?.viewer.cells[0] === 301);
  await settled(page);
  await host.stop();
  for (const cell of [[20, 20, 30], [280, 220, 30], [20, 220, 30], [280, 20, 30], [150, 20, 10]]) {
    await page.evaluate((to) => {
      window.teracell.viewer.go_to_cell(to);
      window.teracell.viewer.zoom.value = 40;
    }, cell);
    await page.waitForTimeout(200);
  }
  await page.getByText("The host of the grids has not answered").waitFor();
  await page.screenshot({ path: join(folder, "lost.png") });
  await host.start();
  await page.getByText("The host of the grids has not answered").waitFor({ state: "detached" });
  await settled(page);
  await page.context().close();
});

// A host of one grid that stops to answer, or answers with another file, after some requests.
async function failing_host(grid, after_requests, how) {
  const bytes = readFileSync(grid_file(grid));
  let requests = 0;
  const host = http_server((request, response) => {
    const late = ++requests > after_requests;
    if (late && how === "silent") return;
    const headers = { "Access-Control-Allow-Origin": "*", "Access-Control-Allow-Headers": "Range", "Access-Control-Expose-Headers": "Content-Range, ETag" };
    if (request.method === "OPTIONS") return response.writeHead(204, headers).end();
    const [, from, to] = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "") ?? [0, 0, bytes.length - 1];
    const part = bytes.subarray(Number(from), Number(to) + 1);
    response.writeHead(request.headers.range ? 206 : 200, {
      ...headers,
      ETag: late ? '"new"' : '"old"',
      "Content-Length": part.length,
      ...(request.headers.range && { "Content-Range": `bytes ${from}-${to}/${bytes.length}` }),
    });
    response.end(request.method === "HEAD" ? undefined : part);
  });
  await new Promise((listening) => host.listen(0, "127.0.0.1", listening));
  return { address: `http://127.0.0.1:${host.address().port}/${grid}.tcell`, stop: () => (host.closeAllConnections(), host.close()) };
}

test("trouble with one grid leaves the others alone", async () => {
  for (const [requests, how] of [
    [0, "silent"],
    [3, "silent"],
    [4, "replaced"],
  ]) {
    const bad = await failing_host("before", requests, how);
    const page = await open_page(browser, `${host.url}/?grid=${encodeURIComponent(bad.address)}&grid=stadium.tcell#g=stadium`, { expected: () => true });
    await page.waitForFunction(() => window.teracell?.idle(), null, { timeout: 10_000 });
    await page.waitForFunction(() => /\d %/.test(document.querySelector("#panel-content").innerText)); // statistics, by the second worker
    assert.equal(await page.getByText("meshed again").count(), 0, how);
    assert.equal(await page.getByText("can't be reached").count(), 0, how);
    await page.context().close();
    bad.stop();
  }
});
