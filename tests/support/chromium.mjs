// Chromium as the tests start it: Debian's, without a graphics card: WebGL2 comes from SwiftShader, which is part of it. Only that:
// with --use-angle=swiftshader the page itself, too, is put together by shaders, which costs ten times as much as without
// (78 instead of 8 ms of processor a frame of the dashboard) and is what no machine without a graphics card does.
export const launch_options = {
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-background-networking"],
};

// What goes wrong on a page, as it happens: its own errors, what it writes to the console as errors, requests to `server` that fail
// or are answered with an error. Of these, `expected(url, status)` says which are meant to be. What the page itself gives up is
// no failure.
export function errors_of(page, server, expected = () => false) {
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    // Chromium writes a line for every failed request: these are judged below.
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
