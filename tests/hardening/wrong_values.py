"""Settings that are wrong, by command: of a wrong type, out of range, or not fitting together."""

WRONG_VALUES = {
    "src/train.py": (
        *(
            "learning.settings.iterations=many",
            "learning.settings.iterations=0",
            "learning.settings.iterations=-3",
        ),
        *(
            "fold=9",
            "fold=first",
            "split=elsewhere",
            "seed=abc",
            "learning.batch_size=0",
            "learning.batch_size=x",
        ),
        *("dataset.data.trials=-1", "dataset.data.hold_out.validation_fraction=2", "model.members=0"),
        *(
            "trainer.settings.accelerator=tpu9",
            "trainer.settings.precision=13",
            "trainer.batches_per_epoch=0",
        ),
        *(
            "learning.settings.learning_rate=fast",
            "robot=baxter",
            "dataset=cornell",
            "learning.settings.schedule=none",
            "dataset.data.views.max_gigabytes=x",
        ),
    ),
    "src/plan.py": (
        *("planner.method.max_iterations=-1", "planner.method.max_iterations=x", "seed=-1", "seed=x"),
        *("planner.prior.weight=1", "planner.prior.weight=heavy", "model=config_cnn", "model=patches_cnn"),
        *("robot=baxter", "planner=no_such", "view=7", "weights=null", "planner.box.position_m=-1"),
    ),
    "src/detect.py": (
        "splits=elsewhere",
        "splits=[elsewhere]",
        "detector.counts=[x]",
        "detector.counts=[0]",
        "robot=lbr4_allegro",
        "runs=null",
    ),
    "src/export.py": ("grasps=0", "grasps=x", "model=palm_points", "model=patches_cnn", "weights=null"),
    "src/render.py": ("dataset.data.folder=null", "patches=maybe", "dataset.data.trials=0", "robot=baxter"),
    "src/fit_prior.py": (
        *(
            "prior.fit.components=0",
            "prior.fit.components=x",
            "prior.fit.components=100000",
            "split=elsewhere",
        ),
        *("fold=9", "robot=baxter"),
    ),
    "sim/collect.py": (
        *(
            "collect.trials=many",
            "collect.trials=0",
            "collect.trials=-5",
            "collect.workers=0",
            "collect.workers=x",
        ),
        *("collect.block=0", "collect.block=x", "collect.seed=-1", "collect.seed=x", "collect.explored=-1"),
        *("collect.explored=x", "collect.repeats=-1", "collect.scene_limit_s=0", "collect.scene_limit_s=x"),
        *("shard=x", "objects.set.density=-1", "objects.set.friction=x", "objects=mesh_folder"),
        *(
            "laboratory.runner.settings.physics.timestep_s=0",
            "laboratory.runner.settings.physics.timestep_s=x",
        ),
        *(
            "laboratory.scenes.only=[no_such_object]",
            "laboratory.scenes.only=no_such_object",
            "robot=two_finger",
        ),
        *("collect.output=null", "camera.view.width=-5", "camera.view.width=wide"),
    ),
    "sim/evaluate.py": (
        *(
            "evaluate.scenes=0",
            "evaluate.scenes=x",
            "evaluate.workers=0",
            "evaluate.seed=-1",
            "evaluate.seed=x",
        ),
        *("model=config_cnn", "model=patches_cnn", "robot=baxter"),
        *(
            "evaluate.filmed_scenes=x",
            "evaluate.poses_per_object=0",
            "weights=null",
            "planners.inference.method=null",
        ),
        *("laboratory.scenes.only=[no_such_object]", "evaluator.recorder.every=0"),
    ),
    "sim/improve.py": (
        "rounds=0",
        "rounds=x",
        "acquired_scenes=x",
        "acquisition=no_such",
    ),
    "sim/replay.py": (
        "trials=[999999999]",
        "trials=x",
        "trials=[x]",
        "trials=0.5",
        "recorder.every=0",
        "trials=[]",
        "table=null",
    ),
    "sim/sensitivity.py": (
        "trials=0",
        "trials=x",
        "trials=99999999",
        "only=[no_such]",
        "only=unchanged",
        "workers=0",
    ),
    "sim/crash_test.py": ("kills=0", "kills=x", "kills_per_table=0", "collect.trials=x"),
    "sim/contact_sheet.py": (
        *("quality=x", "quality=1000", "sheet.columns=0", "portrait.width_px=0", "portrait.width_px=x"),
        *("objects=mesh_folder", "output=sheet.gif"),
    ),
    "sim/last_frames.py": (
        "trials=0",
        "trials=x",
        "trials=99999999",
        "sheet.columns=0",
        "workers=0",
        "quality=x",
    ),
    "sim/write_cornell.py": (
        "maker.margin_px=x",
        "maker.margin_px=-7",
        "maker.workers=0",
        "robot=lbr4_allegro",
    ),
    "analysis/report.py": ("report.results=null", "report.default=no_such"),
}
"""Values of a wrong type, out of range, or that do not fit together."""
