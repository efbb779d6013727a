#!/bin/sh
# An image on a Slurm cluster: an array of jobs that render samples each, and one that adds them up.
#
#   farm.sh SCENE OUT TASKS SAMPLES [WORDS OF jerboa render…]
#
# renders TASKS times SAMPLES per pixel and waits for the image; OUT.parts keeps the parts. Started again, it renders what is
# missing. JERBOA says where the command is, in a folder that all machines see, as SCENE and OUT are.
set -eu
scene=$1 out=$2 tasks=$3 samples=$4
shift 4
JERBOA=${JERBOA:-jerboa}
parts=$out.parts
mkdir -p "$parts"

# What each task of the array runs, under its own number. A task that is killed or moved goes on from its part.
cat > "$parts/task.sh" <<'END'
#!/bin/sh
set -eu
jerboa=$1 scene=$2 parts=$3 samples=$4
shift 4
first=$((SLURM_ARRAY_TASK_ID * samples))
exec "$jerboa" render "$scene" --sample-range "$first..$((first + samples))" -o "$parts/$SLURM_ARRAY_TASK_ID.exr" "$@"
END

array=$(sbatch --parsable --requeue --job-name=jerboa --output="$parts/%a.log" --open-mode=append \
    --array="0-$((tasks - 1))" "$parts/task.sh" "$JERBOA" "$scene" "$parts" "$samples" "$@")
sbatch --wait --job-name=jerboa-merge --output="$parts/merge.log" --dependency="afterok:$array" --kill-on-invalid-dep=yes \
    --wrap="exec '$JERBOA' merge '$parts'/*.exr -o '$out'" > /dev/null || { cat "$parts"/*.log >&2; exit 1; }
cat "$parts/merge.log"
