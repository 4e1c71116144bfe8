/// <reference types="vite/client" />
// Where the module is; null if the page was built without it (vite.config.ts).
declare module "virtual:module" {
  const address: string | null;
  export default address;
}
