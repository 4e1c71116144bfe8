// A picture at an address, for a component. It is fetched like everything else, so that the token goes along.
import { useEffect, useState } from "preact/hooks";
import { get_patiently } from "./api";

// `source`: for an <img>; null until it has come. `error`: why there is none.
const NOTHING: { readonly source: string | null; readonly error: unknown } = { source: null, error: null };

// `address`: null while the picture is not wanted.
export function use_picture(address: string | null): typeof NOTHING {
  const [picture, set_picture] = useState(NOTHING);
  useEffect(() => {
    if (address === null) return;
    const abort = new AbortController();
    let url = "";
    get_patiently(address, abort.signal)
      .then((response) => response.blob())
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
