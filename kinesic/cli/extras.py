"""Error lines with install commands for missing optional packages."""

from kinesic.extras import install_extra

EXTRA_OF_PACKAGE = {  # import name of a package -> extra that installs it
    "cryptography": "cluster",
    "PIL": "film",
    "dask": "cluster",
    "distributed": "cluster",
    "duckdb": "store",
    "foxglove": "mcap",
    "glfw": "face",
    "matplotlib": "plots",
    "mcp": "mcp",
    "pandas": "notebook",
    "rerun": "rerun",
    "scipy": "studies",
    "spacy": "text",
}


def explain_missing(error: ModuleNotFoundError) -> str | None:
    """Return an error line with the install command of a missing package.

    None for packages that belong to no extra.
    """
    package = (error.name or "").partition(".")[0]
    extra = EXTRA_OF_PACKAGE.get(package)
    name = "Pillow" if package == "PIL" else package
    return None if extra is None else f"this needs {name}: {install_extra(extra)}"
