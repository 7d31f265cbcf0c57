  document.querySelectorAll("button[data-copy]").forEach((button) => {
    button.hidden = false;
    button.addEventListener("click", async () => {
      const source = document.getElementById(button.dataset.copy);
      const said = button.parentElement.querySelector("[role=status]");
      try {
        await navigator.clipboard.writeText(source.textContent);
        said.textContent = "Copied.";
      } catch { // Not every browser lets a file write to the clipboard.
        getSelection().selectAllChildren(source);
        said.textContent = document.execCommand("copy")
          ? "Copied." : "Selected: press Ctrl+C or ⌘C.";
      }
    });
  });

  /* On a narrow screen a wide graph is first seen where something is new. */
  const added = document.querySelector(".bondgraph .inserted.element");
  const aside = added?.closest(".wide");
  if (aside) {
    const place = added.getBoundingClientRect(), frame = aside.getBoundingClientRect();
    aside.scrollLeft = place.x + place.width / 2 - frame.x - frame.width / 2;
  }

  /* Light or dark, against what the screen says: the rules for dark screens are made to
     hold always or never. Pictures inside the page have such rules, too. */
  const rules = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules])
    .filter((rule) => rule.conditionText?.includes("prefers-color-scheme"));
  const theme = document.querySelector("button.theme");
  let dark = matchMedia("(prefers-color-scheme: dark)").matches;
  theme.hidden = false;
  theme.textContent = dark ? "Light" : "Dark";
  theme.addEventListener("click", () => {
    dark = !dark;
    rules.forEach((rule) => { rule.media.mediaText = dark ? "screen" : "not all"; });
    document.documentElement.style.colorScheme = dark ? "dark" : "light";
    theme.textContent = dark ? "Light" : "Dark";
  });

  /* What is folded on a screen is there on paper, but for laws too long for a column. */
  const folded = document.querySelectorAll("section > details, figure > details");
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...folded].filter((one) => !one.open);
    opened.forEach((one) => { one.open = true; });
  });
  addEventListener("afterprint", () => opened.forEach((one) => { one.open = false; }));
