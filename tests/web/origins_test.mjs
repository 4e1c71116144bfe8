// What pages of other sites can read of a server on this machine, as a real browser lets them.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import test, { after } from "node:test";
import { grid_file, serve, server_and_browser } from "./support.mjs";

const { server, browser } = await server_and_browser();
const site = createServer((_, response) => response.writeHead(200, { "content-type": "text/html" }).end("<p>A page</p>"));
await new Promise((listening) => site.listen(0, "127.0.0.1", listening));
after(() => site.close());
const elsewhere = `http://site.test:${site.address().port}`; // the browser takes it for another machine

// What a page gets from the server's list of grids: the status and the ids, or why the browser refused.
async function read(origin, url, options = {}) {
  const page = await browser.newPage();
  await page.goto(origin);
  const found = await page.evaluate(
    ([address, given]) => fetch(address, given).then(async (r) => [r.status, (await r.json()).grids.map((g) => g.id)], (error) => String(error)),
    [`${url}api/v1/grids`, options],
  );
  await page.close();
  return found;
}

test("pages of this machine read grids, pages of other sites only when they are allowed", async () => {
  const preflight = { headers: { "If-None-Match": '"x"' } };
  const opened = await serve(grid_file("open"), "--allow-origin", elsewhere);
  for (const options of [{}, preflight]) {
    assert.match(await read(elsewhere, server.url, options), /TypeError/);
    assert.equal((await read(`http://localhost:${site.address().port}`, server.url, options))[0], 200);
    assert.deepEqual(await read(elsewhere, opened.url, options), [200, ["open"]]);
  }
  assert.deepEqual(await opened.stop(), []);
});

test("a page whose own name points to this machine reads nothing", async () => {
  const page = await browser.newPage();
  const answer = await page.goto(`http://site.test:${server.port}/api/v1/grids`);
  assert.equal(answer.status(), 421);
  assert.match((await answer.json()).error.message, /site\.test.*--allow-host/);
  await page.close();
  const named = await serve(grid_file("open"), "--allow-host", "site.test");
  assert.deepEqual(await read(`http://site.test:${named.port}/healthz`, `http://site.test:${named.port}/`), [200, ["open"]]);
  assert.deepEqual(await named.stop(), []);
});
