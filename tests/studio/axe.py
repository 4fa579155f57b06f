"""Accessibility rules of axe-core, a development dependency of the studio's client."""

import json
from pathlib import Path

import pytest

from ..chromium import Page

AXE_SCRIPT = (
    Path(__file__).parents[2] / "kinesic" / "studio" / "client" / "node_modules" / "axe-core" / "axe.min.js"
)  # script of the accessibility checker axe-core, installed by npm
SEVERE_IMPACTS = ("serious", "critical")  # axe-core impact levels that fail a test


def severe_violations(page: Page, *rules: str) -> list[str]:
    """List the serious and critical violations of the current view.

    Args:
        page: page with the view.
        rules: rules to check; by default all.
    """
    if not AXE_SCRIPT.exists():
        pytest.skip("no axe-core: npm ci in kinesic/studio/client")
    if not page.value("'axe' in window"):
        page.call("Runtime.evaluate", expression=AXE_SCRIPT.read_text(encoding="utf-8"))
    options = {"resultTypes": ["violations"]} | ({"runOnly": {"type": "rule", "values": rules}} if rules else {})
    violations = page.value(f"axe.run(document, {json.dumps(options)}).then(result => result.violations)")
    return [
        f"{each['id']} ({each['impact']}): {', '.join(' '.join(node['target']) for node in each['nodes'])}"
        for each in violations
        if each["impact"] in SEVERE_IMPACTS
    ]
