// Asks for the token of a server that demands one.
import { useState } from "preact/hooks";
import { Mark } from "./header";
import { fault_of_token, give_token, has_token } from "./server/api";

export function TokenForm() {
  const [text, set_text] = useState("");
  const token = text.trim();
  const fault = fault_of_token(token);
  const open = (event: Event) => {
    event.preventDefault();
    if (token && !fault) give_token(token);
  };
  return (
    <main class="token-page">
      <form class="token-form" onSubmit={open}>
        <h1>
          <Mark /> teracell
        </h1>
        <p>{has_token() ? "The server refused this token." : "This server asks for a token."}</p>
        <label>
          Access token
          <input
            type="password"
            name="token"
            autocomplete="current-password"
            autofocus
            value={text}
            onInput={(e) => set_text(e.currentTarget.value)}
          />
        </label>
        <button class="button primary" type="submit" disabled={!token || fault !== null}>
          Open
        </button>
        {fault && <p role="alert">{fault}</p>}
        <p class="note">The token is kept in this tab only, until the tab is closed.</p>
      </form>
    </main>
  );
}
