// Starts the page.
import { render } from "preact";
import { App } from "./app";
import { addresses, open_addresses, watch_drops } from "./local_files";

// No await at the top: what is loaded when it is needed imports from here, and would wait for that.
async function start(): Promise<void> {
  watch_drops();
  if (addresses().length > 0) await open_addresses();
  render(<App />, document.getElementById("app")!);
}
void start();
