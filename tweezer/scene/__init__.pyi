from .scene import (
    FREE,
    SHIPPED,
    Scene,
    SceneLike,
    by_key,
    checked_scene,
    described_at,
    load_scene,
    settable,
    shipped_scenes,
    value_at,
    with_settings,
)

__all__ = [
    "FREE",
    "SHIPPED",
    "Scene",
    "SceneLike",
    "by_key",
    "checked_scene",
    "described_at",
    "load_scene",
    "settable",
    "shipped_scenes",
    "value_at",
    "with_settings",
]
