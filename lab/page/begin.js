// Makes the import map of the modules' JSON, which is packed in lab.html, and begins with one of them. It stays in the page until that runs.
addEventListener("DOMContentLoaded", async () => {
  const modules = document.getElementById("modules");
  const bytes = () => Uint8Array.from(atob(modules.textContent), (c) => c.charCodeAt(0));
  const unpacked = () => new Response(new Blob([bytes()]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  const json = modules.type === "text/plain" ? await unpacked() : modules.textContent;
  const imports = Object.fromEntries(Object.entries(JSON.parse(json)).map(([name, text]) => [name, `data:text/javascript,${encodeURIComponent(text)}`]));
  document.head.append(Object.assign(document.createElement("script"), { type: "importmap", textContent: JSON.stringify({ imports }) }));
  await import("MAIN");
  modules.remove();
});
