// Where the page finds what is not loaded with it, if the whole page is one file: in elements of its own (vite.config.ts).
import type * as beside from "./beside";
import { bytes_of, held_text } from "./held";
import PageWorker from "./worker?worker&inline";

export const has_module: typeof beside.has_module = true;

export const module_code: typeof beside.module_code = () => bytes_of(held_text("module"));

export const make_worker: typeof beside.make_worker = () => new PageWorker();

export const whole_page: typeof beside.whole_page = null;

let notice = "";
export const notice_address: typeof beside.notice_address = () =>
  (notice ||= URL.createObjectURL(new Blob([held_text("notice")], { type: "text/plain; charset=utf-8" })));
