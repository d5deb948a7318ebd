// Unpacks the modules, and begins with one of them. They stay in the page until it runs.
addEventListener("DOMContentLoaded", async () => {
  const modules = document.getElementById("modules");
  const packed = Uint8Array.from(atob(modules.textContent), (c) => c.charCodeAt(0));
  const sources = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).json();
  const imports = Object.fromEntries(Object.entries(sources).map(([name, text]) => [name, `data:text/javascript,${encodeURIComponent(text)}`]));
  document.head.append(Object.assign(document.createElement("script"), { type: "importmap", textContent: JSON.stringify({ imports }) }));
  await import("MAIN");
  modules.remove();
});
