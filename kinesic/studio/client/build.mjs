// Bundles the page's script into ../page/studio.js, and writes into it which sources it was made from; --check compares.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const HERE = dirname(fileURLToPath(import.meta.url));
const SHARED = ["shapes.js", "motion.js", "skin.js", "screen.js", "scene.js"].map((name) =>
  join(HERE, "../../report/templates", name),
);
const sources = readdirSync(join(HERE, "src"), { recursive: true })
  .filter((name) => name.endsWith(".ts"))
  .map((name) => name.replaceAll("\\", "/"))
  .sort()
  .map((name) => join(HERE, "src", name));

// The scripts of the report's player are no modules: together they make one here.
const scene = {
  name: "scene",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^kinesic:scene$/ }, () => ({ path: "scene", namespace: "shared" }));
    onLoad({ filter: /.*/, namespace: "shared" }, () => ({
      contents: `${SHARED.map((path) => readFileSync(path, "utf8")).join("\n")}\nexport { sceneOf, rowAt, plainFace };`,
    }));
  },
};

// As tests/studio/test_bundle.py does, without node.
const digest = createHash("sha256");
for (const path of [...sources, ...SHARED]) digest.update(readFileSync(path));

const OUT = join(HERE, "../page/studio.js");
const { outputFiles } = await build({
  entryPoints: [join(HERE, "src/app.ts")],
  write: false,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
  banner: { js: `// kinesic studio, made from sources ${digest.digest("hex")}` },
  plugins: [scene],
});

const made = outputFiles[0].text;
if (!process.argv.includes("--check")) writeFileSync(OUT, made);
else if (readFileSync(OUT, "utf8") !== made) {
  console.error("kinesic/studio/page/studio.js is not what its sources make: make studio");
  process.exit(1);
}
