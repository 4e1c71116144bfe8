// Chromium as the tests start it: Debian's headless shell, which is the browser without windows of its own, and takes half the processor time:
// the whole browser draws its toolbars also where nobody sees them. Where a system packages none (Ubuntu), npm's is taken. No graphics card is
// there. WebGL 2 comes from SwiftShader, which is part of Chromium, and nothing else does. With --use-angle=swiftshader shaders would also put
// the page itself together. That costs ten times as much (78 instead of 8 ms of processor time per frame of the dashboard), and no machine
// without a graphics card works that way.
import { existsSync } from "node:fs";
import { createRequire } from "node:module";

const packaged = "/usr/bin/chromium-headless-shell";
const fetched = () => createRequire(new URL("browser/package.json", import.meta.url))("@sparticuz/chromium").executablePath();

export const launch_options = {
  executablePath: existsSync(packaged) ? packaged : await fetched(),
  // Names below .test are this machine's, but only to the resolver: pages from there are pages of other sites.
  args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-background-networking", "--host-resolver-rules=MAP *.test 127.0.0.1"],
};

// Collects what goes wrong on a page: its own errors, errors that it writes to the console, and requests to `server` that fail or are
// answered with an error. `expected(url, status)` says which of these requests are meant to. A request that the page itself gives up
// is no failure.
export function errors_of(page, server, expected = () => false) {
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    // Chromium writes a line for every failed request. Those requests are judged below.
    if (message.type() === "error" && !message.text().startsWith("Failed to load resource")) errors.push(message.text());
  });
  page.on("requestfailed", (request) => {
    const why = request.failure().errorText;
    if (request.url().startsWith(server) && why !== "net::ERR_ABORTED" && !expected(request.url(), 0)) errors.push(`${request.url()}: ${why}`);
  });
  page.on("response", (response) => {
    if (response.url().startsWith(server) && response.status() >= 400 && !expected(response.url(), response.status())) errors.push(`${response.url()}: ${response.status()}`);
  });
  return errors;
}
