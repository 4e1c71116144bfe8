// A picture at an address. It is fetched like everything else, so that the token goes along.
import { useEffect, useState } from "preact/hooks";
import { ServerError, get_patiently } from "./api";
import { until_returned } from "./connection";

// Waits for a server that is lost.
export async function picture_at(address: string, signal: AbortSignal): Promise<Blob> {
  for (;;) {
    try {
      return await (await get_patiently(address, signal)).blob();
    } catch (error) {
      if (!(error instanceof ServerError && error.code === "unreachable")) throw error;
    }
    await until_returned();
    signal.throwIfAborted();
  }
}

// `source`: for an <img>; null until it has come. `error`: why there is none.
const NOTHING: { readonly source: string | null; readonly error: unknown } = { source: null, error: null };

// For a component. `address`: null while the picture is not wanted.
export function use_picture(address: string | null): typeof NOTHING {
  const [picture, set_picture] = useState(NOTHING);
  useEffect(() => {
    if (address === null) return;
    const abort = new AbortController();
    let url = "";
    picture_at(address, abort.signal)
      .then((blob) => {
        if (!abort.signal.aborted) set_picture({ source: (url = URL.createObjectURL(blob)), error: null });
      })
      .catch((error: unknown) => abort.signal.aborted || set_picture({ source: null, error }));
    return () => {
      abort.abort();
      URL.revokeObjectURL(url);
      set_picture(NOTHING);
    };
  }, [address]);
  return picture;
}
